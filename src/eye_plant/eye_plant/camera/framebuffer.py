"""Where pictures are drawn: one byte of colour and four of depth and stencil per pixel.

MuJoCo's off-screen buffer takes four and eight. Software rasterisers spend much of their time on
moving these; the pixels are the same.
"""

from types import ModuleType

from eye_plant.camera.offscreen import GraphicsError


class GreyFramebuffer:
    """Renderbuffers in attachment of those that a renderer made for its frame buffer."""

    def __init__(self, gl: ModuleType, framebuffer: int, width_px: int, height_px: int) -> None:
        """Attach them to the frame buffer of that OpenGL name, in the current context.

        Only red is kept of what is drawn. Raises GraphicsError when OpenGL refuses.
        """
        self._gl = gl
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, framebuffer)
        self._names = [
            self._attach(kind, attachment, width_px, height_px)
            for kind, attachment in (
                (gl.GL_R8, gl.GL_COLOR_ATTACHMENT0),
                (gl.GL_DEPTH24_STENCIL8, gl.GL_DEPTH_STENCIL_ATTACHMENT),
            )
        ]
        status = gl.glCheckFramebufferStatus(gl.GL_FRAMEBUFFER)
        if status != gl.GL_FRAMEBUFFER_COMPLETE:
            raise GraphicsError(
                f"expected OpenGL to draw into one byte of colour per pixel, got status {status:#x}"
            )

    def _attach(self, kind: int, attachment: int, width_px: int, height_px: int) -> int:
        gl = self._gl
        name = int(gl.glGenRenderbuffers(1))
        gl.glBindRenderbuffer(gl.GL_RENDERBUFFER, name)
        gl.glRenderbufferStorage(gl.GL_RENDERBUFFER, kind, width_px, height_px)
        gl.glFramebufferRenderbuffer(gl.GL_FRAMEBUFFER, attachment, gl.GL_RENDERBUFFER, name)
        return name

    def delete(self) -> None:
        """Free the renderbuffers, in the current context."""
        self._gl.glDeleteRenderbuffers(len(self._names), self._names)
