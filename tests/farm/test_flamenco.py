"""Flamenco's job type, run in a JavaScript engine with a manager of its own."""

import json
from pathlib import Path

import pytest
import quickjs

from addon.cli.arguments import parse

SCRIPT = Path(__file__).resolve().parents[2] / "farm" / "flamenco" / "aplanat.js"
# What Flamenco's manager gives job compilers, as far as ours uses it.
MANAGER = """
const author = {
    Task: (name, type) => ({
        name, type, commands: [], addCommand(command) { this.commands.push(command); },
    }),
    Command: (name, parameters) => ({ name, parameters }),
};
function frameChunker(frames, size) {
    const numbers = frames.split(",").flatMap((part) => {
        const [first, last] = part.split("-").map(Number);
        return Array.from({ length: (last || first) - first + 1 }, (_, i) => first + i);
    });
    const chunks = [];
    for (let i = 0; i < numbers.length; i += size) {
        const chunk = numbers.slice(i, i + size);
        const isRow = chunk[chunk.length - 1] - chunk[0] === chunk.length - 1;
        chunks.push(
            isRow && chunk.length > 1 ? `${chunk[0]}-${chunk[chunk.length - 1]}` : chunk.join(","),
        );
    }
    return chunks;
}
function compiled(settings) {
    const job = { settings, tasks: [], addTask(task) { this.tasks.push(task); } };
    compileJob(job);
    return JSON.stringify(job.tasks);
}
"""


@pytest.fixture(scope="module")
def flamenco():
    context = quickjs.Context()
    context.eval(MANAGER)
    context.eval(SCRIPT.read_text(encoding="utf-8"))
    return context


@pytest.fixture
def tasks(flamenco):
    """Compile a job; settings as Flamenco's add-on would fill them in, and those given."""
    declared = json.loads(flamenco.eval("JSON.stringify(JOB_TYPE)"))["settings"]

    def run(**given):
        settings = {one["key"]: one["default"] for one in declared if "default" in one}
        settings |= {
            "frames": "1-24",
            "blendfile": "/shots/a b/7.blend",
            "render_output_path": "/out/job/frame_######.exr",
        }
        settings |= given
        assert settings.keys() <= {one["key"] for one in declared}
        return json.loads(flamenco.eval(f"compiled({json.dumps(settings)})"))

    return run


def words(task):
    (command,) = task["commands"]
    assert command["name"] == "exec" and command["parameters"]["exe"] == "{blender}"
    blenders, ours = command["parameters"]["args"][:2], command["parameters"]["args"][2:]
    assert blenders == ["--command", "aplanat"]
    return ours


def test_tasks_are_chunks_of_frames(tasks):
    made = tasks()
    assert [task["name"] for task in made] == [
        f"render-{chunk}" for chunk in ("1-5", "6-10", "11-15", "16-20", "21-24")
    ]
    assert {task["type"] for task in made} == {"blender"}
    frames = [number for task in made for number in parse(words(task)).frames.numbers(2)]
    assert frames == list(range(1, 25))


def test_our_command_line_understands_what_is_called(tasks):
    (task,) = tasks(frames="3,8-9", options="--samples 4 --lens 'a lens.toml' --strict")
    arguments = parse(words(task))
    assert (arguments.command, str(arguments.scene)) == ("render", "/shots/a b/7.blend")
    assert [str(path) for path in arguments.output] == ["/out/job/frame_######.exr"]
    assert list(arguments.frames.numbers()) == [3, 8, 9]
    assert (arguments.samples, arguments.lens, arguments.strict) == (4, "a lens.toml", True)
    assert arguments.make_folders
    assert parse(words(tasks(make="capture", options="")[0])).strict is False
    assert parse(words(tasks(make="capture")[0])).command == "capture"


def test_refocus_takes_captured_files(tasks):
    made = tasks(make="refocus", layers="/shots/7/layers_####.exr", options="--focus 3.2")
    arguments = parse(words(made[0]))
    assert (arguments.command, str(arguments.layers)) == ("refocus", "/shots/7/layers_####.exr")
    assert arguments.focus == 3.2
    with pytest.raises(quickjs.JSException, match="captured files"):
        tasks(make="refocus")


def test_settings_are_what_flamenco_knows(flamenco):
    # Of Flamenco 3's interface: AvailableJobSetting.
    known = {"key", "type", "subtype", "choices", "propargs", "description", "default", "eval"}
    known |= {"evalInfo", "visible", "required", "editable", "label"}
    for one in json.loads(flamenco.eval("JSON.stringify(JOB_TYPE)"))["settings"]:
        assert one.keys() <= known
        assert one["type"] in {"string", "int32", "float", "bool"}
        assert one.get("subtype", "file_path") in {"file_path", "dir_path", "hashed_file_path"}
        assert one.get("visible", "web") in {"visible", "submission", "web", "hidden"}
