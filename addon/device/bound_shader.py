"""A compiled shader with its declared resources and those that the compiler has kept.

A driver may optimise away resources that a variant does not read, and Blender then refuses to set
them: with an error for numbers and blocks, silently for textures, depending on driver and backend.
Here, setting a resource that was declared but optimised away does nothing, and setting one that was
never declared is an error everywhere.
"""

from ..errors import ShaderResourceError

CONSTANT, BLOCK, SAMPLER, IMAGE = "push constant", "uniform block", "sampler", "image"


class Shader:
    """A compiled shader with its declarations.

    Parameters
    ----------
    info : device.shaders.ShaderInfo
    program : GPUShader

    Attributes
    ----------
    info : device.shaders.ShaderInfo
    program : GPUShader
        Blender's own shader.
    """

    __slots__ = ("_declared", "_given", "_needed", "_sets_constant", "info", "program")

    def __init__(self, info, program):
        self.info = info
        self.program = program
        self._declared = {constant[1]: CONSTANT for constant in info.push_constants}
        self._declared |= {name: BLOCK for _, name in info.uniforms}
        self._declared |= {name: SAMPLER for _, name in info.samplers}
        self._declared |= {image[2]: IMAGE for image in info.images}
        self._sets_constant = {
            constant[1]: _has(program.uniform_from_name, constant[1])
            for constant in info.push_constants
        }
        # Resources that have to be set before each drawing. Binding a block or texture that was
        # optimised away does no harm, so all declared ones are required: a drawing must never read
        # what another pass has left bound.
        self._needed = frozenset(
            name
            for name, kind in self._declared.items()
            if kind != CONSTANT or self._sets_constant[name]
        )
        self._given = set()

    def declares(self, name):
        """Whether this variant was declared with a resource of this name."""
        return name in self._declared

    def bind(self):
        """Make it the current shader; all its resources have to be set afterwards."""
        self._given.clear()
        self.program.bind()

    def uniform_int(self, name, value):
        """Set a push constant of whole numbers.

        Raises
        ------
        ShaderResourceError
            If it was never declared.
        """
        if self._takes(name, CONSTANT) and self._sets_constant[name]:
            self.program.uniform_int(name, value)

    def uniform_float(self, name, value):
        """Set a push constant of floats, vectors or matrices.

        Raises
        ------
        ShaderResourceError
            If it was never declared.
        """
        if self._takes(name, CONSTANT) and self._sets_constant[name]:
            self.program.uniform_float(name, value)

    def uniform_block(self, name, buffer):
        """Bind a uniform block.

        Raises
        ------
        ShaderResourceError
            If it was never declared.
        """
        if self._takes(name, BLOCK):
            self.program.uniform_block(name, buffer)

    def uniform_sampler(self, name, texture):
        """Bind a texture that is sampled.

        Raises
        ------
        ShaderResourceError
            If it was never declared.
        """
        if self._takes(name, SAMPLER):
            self.program.uniform_sampler(name, texture)

    def image(self, name, texture):
        """Bind a texture that is read and written as an image.

        Raises
        ------
        ShaderResourceError
            If it was never declared.
        """
        if self._takes(name, IMAGE):
            self.program.image(name, texture)

    def draw(self, batch):
        """Draw a batch; the shader must be bound.

        Raises
        ------
        ShaderResourceError
            If something that the shader reads was not set since it was bound.
        """
        self.check_given()
        batch.draw(self.program)

    def draw_instanced(self, batch, count):
        """Draw a batch `count` times; the shader must be bound.

        Raises
        ------
        ShaderResourceError
            If something that the shader reads was not set since it was bound.
        """
        self.check_given()
        batch.draw_instanced(self.program, instance_count=count)

    def check_given(self):
        """Raise an error if a resource that the shader reads was not set since it was bound."""
        # Names are only given if they are declared; a count would let what was left out stand for
        # what is missing.
        if not self._needed <= self._given:
            missing = sorted(self._needed - self._given)
            raise ShaderResourceError(self.info.name, missing, "read but not set")

    def _takes(self, name, kind):
        if self._declared.get(name) != kind:
            raise ShaderResourceError(self.info.name, [name], f"no {kind} of this shader")
        self._given.add(name)
        return True


def _has(find, name):
    try:
        find(name)
    except ValueError:
        return False
    return True
