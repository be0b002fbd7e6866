# Sourced by the other scripts: finds Python 3.13 and Blender, makes .venv with the pinned packages
# and gets the system libraries that bpy needs. Only defines; set_up does the work.
# shellcheck shell=bash

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$repo/.venv

# What bpy and its software OpenGL load and a bare Debian lacks.
system_packages=(
    libegl1 libgl1 libgl1-mesa-dri
    libice6 libsm6 libx11-6 libxext6 libxfixes3 libxi6 libxkbcommon0 libxrender1
)

python_advice() {
    echo "set APLANAT_PYTHON to a Python 3.13, or install one" \
        "(pyenv install 3.13, uv python install 3.13)"
}

fail() {
    echo "aplanat: $*" >&2
    return 1
}

is_python_313() {
    "$1" -c 'import sys, venv, ensurepip, ssl; sys.exit(sys.version_info[:2] != (3, 13))' \
        2>/dev/null
}

# Prints the path of a working Python 3.13.
find_python() {
    local candidate candidates=()
    [[ -n ${APLANAT_PYTHON-} ]] && candidates+=("$APLANAT_PYTHON")
    candidates+=("$(command -v python3.13 || true)" "$(command -v python3 || true)")
    candidates+=("${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.13*/bin/python3.13)
    if command -v uv >/dev/null; then
        candidates+=("$(uv python find --no-project 3.13 2>/dev/null || true)")
    fi
    candidates+=("${UV_PYTHON_INSTALL_DIR:-$HOME/.local/share/uv/python}"/cpython-3.13*/bin/python3.13)
    for candidate in "${candidates[@]}"; do
        if [[ -n $candidate ]] && is_python_313 "$candidate"; then
            echo "$candidate"
            return
        fi
    done
    return 1
}

# Prints the path of a Blender 5.2 or later: $BLENDER, PATH, or what scripts/get-blender made.
# Returns 1 where there is none, 2 where $BLENDER is wrong.
find_blender() {
    local candidate
    if [[ -n ${BLENDER-} ]]; then
        is_new_blender "$BLENDER" || fail "BLENDER=$BLENDER is not a Blender 5.2 or later" || return 2
        echo "$BLENDER"
        return
    fi
    candidate=$(command -v blender || true)
    if [[ -n $candidate ]] && is_new_blender "$candidate"; then
        echo "$candidate"
        return
    fi
    "$repo/scripts/get-blender" --check
}

is_new_blender() {
    local version
    version=$("$1" --version 2>/dev/null | sed -n 's/^Blender \([0-9]*\.[0-9]*\).*/\1/p;T;q') || return
    [[ -n $version && $(printf '5.2\n%s\n' "$version" | sort -V | head -n1) == 5.2 ]]
}

install_apt_packages() {
    export DEBIAN_FRONTEND=noninteractive
    apt-get update && apt-get install -y --no-install-recommends "$@"
}

requirements_stamp() {
    cat "$repo"/requirements*.txt "${BASH_SOURCE[0]}" | sha256sum
}

is_set_up() {
    [[ -x $venv/bin/python && -r $venv/.stamp && $(<"$venv/.stamp") == "$(requirements_stamp)" ]]
}

# Makes the checkout ready; returns at once where it is.
set_up() {
    is_set_up && return
    (
        if command -v flock >/dev/null; then
            flock 8
            is_set_up && exit 0
        fi
        make_venv && install_system_libraries && requirements_stamp >"$venv/.stamp"
    ) 8>"$repo/.venv.lock"
}

make_venv() {
    local python
    if ! "$venv/bin/python" -m pip --version >/dev/null 2>&1; then
        python=$(find_python) || fail "no Python 3.13: $(python_advice)" || return
        echo "aplanat: making .venv with $("$python" --version)" >&2
        rm -rf "$venv"
        "$python" -m venv "$venv" || return
    fi
    echo "aplanat: installing the pinned Python packages" >&2
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --only-binary=:all: \
        -r "$repo/requirements-dev.txt" >&2 || fail "pip could not install requirements-dev.txt"
}

# Whether Blender's module finds its libraries and a GPU (Mesa's software OpenGL will do).
has_gpu() {
    {
        "$venv/bin/python" -c 'import bpy, gpu; gpu.init(); gpu.platform.renderer_get()' \
            >"$venv/gpu.log" 2>&1
    } 2>/dev/null # the shell's own word when Blender's module aborts
}

install_system_libraries() {
    has_gpu && return
    if ((EUID == 0)) && command -v apt-get >/dev/null; then
        echo "aplanat: installing ${system_packages[*]}" >&2
        install_apt_packages "${system_packages[@]}" >"$venv/apt.log" 2>&1 ||
            fail "apt-get failed, see .venv/apt.log" || return
        has_gpu && return
        tail -n 3 "$venv/gpu.log" >&2
        fail "Blender's module finds no GPU, see .venv/gpu.log"
    else
        tail -n 1 "$venv/gpu.log" >&2
        fail "install the libraries that Blender needs: apt-get install ${system_packages[*]}"
    fi
}
