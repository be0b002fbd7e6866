"""Uniform blocks: a struct written once, in GLSL, and packed from Python by the std140 rules.

The struct's declaration in ``gpu_shaders/shared/`` is parsed; its members become the keyword
arguments of `UniformStruct.pack`.
"""

import re
from dataclasses import dataclass

import numpy as np

from ..errors import ShaderCompileError
from .shader_source import load

# type: (base alignment, size in bytes, numpy dtype, shape of one element as rows of floats)
_TYPES = {
    "float": (4, 4, np.float32, (1,)),
    "int": (4, 4, np.int32, (1,)),
    "uint": (4, 4, np.uint32, (1,)),
    "vec2": (8, 8, np.float32, (2,)),
    "vec4": (16, 16, np.float32, (4,)),
    "ivec4": (16, 16, np.int32, (4,)),
    "uvec4": (16, 16, np.uint32, (4,)),
    "mat4": (16, 64, np.float32, (4, 4)),
}

_STRUCT = re.compile(r"struct\s+(\w+)\s*\{([^}]*)\}\s*;")
_MEMBER = re.compile(r"(\w+)\s+(\w+)\s*(?:\[\s*(\d+)\s*\])?\s*;")
_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


@dataclass(frozen=True)
class Member:
    """One member of a struct: its type, byte offset, and array length (0 for none)."""

    type_name: str
    offset: int
    length: int


class UniformStruct:
    """A GLSL struct whose values are packed as a std140 block.

    Parameters
    ----------
    path : str
        Shader file below ``gpu_shaders/`` that declares the struct.
    name : str
        The struct's name.
    """

    def __init__(self, path, name):
        self.path = path
        self.name = name
        self.source = load(path)
        self.members = {}
        self.size = self._lay_out()

    def _lay_out(self):
        text = _COMMENT.sub("", self.source)
        body = next((m.group(2) for m in _STRUCT.finditer(text) if m.group(1) == self.name), None)
        if body is None:
            raise ShaderCompileError(self.path, f"no struct {self.name} in this file")
        offset = 0
        for type_name, name, length in _MEMBER.findall(body):
            if type_name not in _TYPES:
                raise ShaderCompileError(
                    self.path, f"{self.name}.{name}: type {type_name} has no packer"
                )
            alignment, size, _, _ = _TYPES[type_name]
            count = int(length or 0)
            if count:
                # std140: array elements are padded to 16 bytes.
                alignment = 16
                size = count * ((size + 15) // 16 * 16)
            offset = (offset + alignment - 1) // alignment * alignment
            self.members[name] = Member(type_name, offset, count)
            offset += size
        return (offset + 15) // 16 * 16

    def pack(self, **values):
        """Return the block's bytes.

        Parameters
        ----------
        **values
            One for each member: a number, a sequence, or for ``mat4`` a (4, 4) array that acts on
            column vectors; arrays may be shorter than declared.

        Returns
        -------
        bytes
        """
        if values.keys() != self.members.keys():
            odd = sorted(values.keys() ^ self.members.keys())
            raise TypeError(f"{self.name}.pack: missing or unknown members {', '.join(odd)}")
        block = np.zeros(self.size, np.uint8)
        for name, value in values.items():
            self._write(block, self.members[name], np.asarray(value))
        return block.tobytes()

    def _write(self, block, member, value):
        _, size, dtype, shape = _TYPES[member.type_name]
        if member.type_name == "mat4":
            value = np.swapaxes(value, -1, -2)
        count = member.length
        if count:
            value = value.reshape(-1, int(np.prod(shape)))
            stride = (size + 15) // 16 * 16
        else:
            value = value.reshape(1, int(np.prod(shape)))
            stride = size
        if len(value) > max(count, 1):
            raise TypeError(f"{self.name}: {len(value)} elements given, {count} declared")
        for i, row in enumerate(value):
            data = np.ascontiguousarray(row, dtype).view(np.uint8)
            start = member.offset + i * stride
            block[start : start + data.size] = data
