"""Environments to light: spherical harmonics, prefiltered reflections, irradiance and computed skies.

    import welkin

    light = welkin.bake("city.hdr", specular=dict(size=512), progress=True)
    light.specular.levels[0]        # (6, 512, 512, 3) float32
    light.radiance.irradiance()((0, 1, 0))

Pixels are numpy arrays, read where they lie: (height, width, channels) is a lat-long, (6, n, n, channels) the faces
+X -X +Y -Y +Z -Z of a cubemap; 3 or 4 channels of float32, float16 or uint8. Axes are right-handed, y up; a lat-long's
centre looks along +z, with +x a quarter in from the left. Results are arrays on memory of the library's own.
"""
from . import _interpreter  # first: it refuses where the extension would wait forever
from . import _welkin
from ._errors import (
    Cancelled,
    CorruptFile,
    Error,
    FileAccess,
    FileNotFound,
    InvalidArgument,
    LimitExceeded,
    QueueFull,
    RejectedPixel,
    Replaced,
    Stopped,
    UnsupportedFile,
)
from ._welkin import *  # noqa: F401,F403
from ._welkin import __version__  # noqa: F401


def _show_as_image(kind):
    """Notebooks draw what has `_repr_png_`."""

    def _repr_png_(self):
        pixels = self.pixels
        return None if pixels is None else preview(pixels)  # noqa: F405

    kind._repr_png_ = _repr_png_


for _kind in (Environment, Chain, Bake, Irradiance):  # noqa: F405
    _show_as_image(_kind)

__all__ = [name for name in dir(_welkin) if not name.startswith("_")] + [
    "Cancelled",
    "CorruptFile",
    "Error",
    "FileAccess",
    "FileNotFound",
    "InvalidArgument",
    "LimitExceeded",
    "QueueFull",
    "RejectedPixel",
    "Replaced",
    "Stopped",
    "UnsupportedFile",
]
