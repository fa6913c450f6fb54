"""Types of the package; docstrings are the extension's own. tests/test_stubs.py holds the two together."""
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, Literal, SupportsIndex, TypeAlias, TypedDict, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

# Arguments of calls.
_Path: TypeAlias = str | os.PathLike[str]
_File: TypeAlias = _Path | bytes
_Array: TypeAlias = NDArray[np.float32] | NDArray[np.float16] | NDArray[np.uint8]
_Image: TypeAlias = Environment | Chain | Bake | Irradiance
_Pixels: TypeAlias = _Array | Sequence[_Array] | _Image | _File
_Progress: TypeAlias = bool | Callable[[float], object] | None
_Layout: TypeAlias = (
    Literal["lat-long", "vertical-strip", "horizontal-strip", "horizontal-cross", "vertical-cross"] | None
)
_Encoding: TypeAlias = Literal["linear", "srgb"] | None
_FileLayout: TypeAlias = Literal[
    "automatic", "lat-long", "vertical-strip", "horizontal-strip", "horizontal-cross", "vertical-cross", "six-files"
]
_Transfer: TypeAlias = Literal["automatic", "srgb", "linear"]
_Primaries: TypeAlias = Literal["rec709", "as-stored"]
_SampleType: TypeAlias = Literal["automatic", "half", "float", "uint8", "uint16"]
_TexelFormat: TypeAlias = Literal[
    "rgba16f",
    "rgba32f",
    "b10g11r11",
    "e5b9g9r9",
    "bc6h_ufloat",
    "bc6h_sfloat",
    "astc_4x4_hdr",
    "astc_6x6_hdr",
    "uastc_hdr_4x4",
]
_Quadrature: TypeAlias = Literal["exact", "midpoint"]
_SkyQuadrature: TypeAlias = Literal["uniform", "gauss", "gauss-split"]
_Method: TypeAlias = Literal["automatic", "spectral", "reference"]
_Quality: TypeAlias = Literal["normal", "fast", "reference"]
_Lobe: TypeAlias = Literal["ggx", "charlie", "lambert", "phong", "blinn", "spectra"]
_Schedule: TypeAlias = Literal["linear", "filament", "babylon", "unity", "unreal"]
_Window: TypeAlias = Literal["none", "hanning", "lanczos", "min-laplacian"]
_Engine: TypeAlias = Literal["babylon", "three", "filament", "gltf", "unity", "unreal", "godot", "welkin"]
_Weight: TypeAlias = Literal["luminance", "mean", "largest"]
_Resampling: TypeAlias = Literal["area", "bilinear"]
_MipFilter: TypeAlias = Literal["solid-angle", "box"]
_BrdfModel: TypeAlias = Literal["split-sum", "multiple-scattering"]
_IrradianceMethod: TypeAlias = Literal["harmonics", "direct"]
_BakedIrradianceMethod: TypeAlias = Literal["automatic", "direct", "harmonics"]
_Action: TypeAlias = Literal["run", "reuse", "skip"]

class _Read(TypedDict, total=False):
    layout: _FileLayout
    part: str
    layer: str
    level: int
    element: int
    transfer: _Transfer
    primaries: _Primaries
    memory_limit: int

class _Background(TypedDict, total=False):
    size: int
    mips: bool
    mip_filter: _MipFilter

class _Specular(TypedDict, total=False):
    size: int
    mips: int
    roughness: Sequence[float] | _Schedule
    lobe_roughness: Sequence[float] | Literal["fitted"]
    lobe: _Lobe
    spectra: Sequence[Sequence[float]]
    method: _Method
    quality: _Quality
    rms_error: float
    maximum_error: float

class _Octahedral(TypedDict, total=False):
    size: int
    levels: int
    border: int

class _IrradianceCubemap(TypedDict, total=False):
    size: int
    method: _BakedIrradianceMethod
    rms_error: float

class _Brdf(TypedDict, total=False):
    width: int
    height: int
    model: _BrdfModel
    sheen: bool

class _Needs(TypedDict, total=False):
    diffuse_bands: int
    irradiance_cubemap: bool
    glossy: bool | tuple[float, float]
    background: bool
    background_mips: bool
    brdf_table: bool
    stored_results: bool

# Results of calls.
class _Written(TypedDict):
    files: list[Path]
    values_clamped: int

class _Info(TypedDict):
    path: Path
    format: str
    layout: str
    layout_reason: str
    width: int
    height: int
    compression: str
    storage: str
    channels: list[tuple[str, str]]
    levels: list[tuple[int, int]]
    parts: list[str]
    layers: list[str]
    notes: list[str]

class _Statistics(TypedDict):
    texels: int
    minimum: NDArray[np.float64]
    maximum: NDArray[np.float64]
    mean: NDArray[np.float64]
    total_radiance: NDArray[np.float64]
    nans: int
    infinities: int
    negatives: int
    brightest: NDArray[np.float64]
    brightest_direction: NDArray[np.float64]

class _SunPosition(TypedDict):
    elevation: float
    azimuth: float
    compass: float
    refraction: float
    distance: float
    direction: NDArray[np.float64]

class _Sun(TypedDict):
    direction: NDArray[np.float64]
    irradiance: NDArray[np.float64]
    radiance: NDArray[np.float64]
    solid_angle: float
    angular_radius_degrees: float

class _SkyTables(TypedDict):
    transmittance: NDArray[np.float32]
    scattering: NDArray[np.float32]
    single_mie: NDArray[np.float32] | None
    irradiance: NDArray[np.float32]

# ---- Errors

class Error(Exception):
    code: str

class InvalidArgument(Error, ValueError): ...
class RejectedPixel(Error, ValueError): ...
class FileAccess(Error, OSError): ...
class FileNotFound(FileAccess, FileNotFoundError): ...
class CorruptFile(Error, ValueError): ...
class UnsupportedFile(Error, ValueError): ...
class LimitExceeded(Error, MemoryError): ...
class Cancelled(Error): ...
class Replaced(Error): ...
class QueueFull(Error): ...
class Stopped(Error): ...

# ---- The machine

def available_threads() -> int: ...
def keep_working_memory(bytes: int) -> None: ...
def release_working_memory() -> None: ...
def instruction_set() -> Literal["sse2", "avx2", "avx512", "neon", "simd128"]: ...

# ---- Spherical harmonics

class SphericalHarmonics:
    @overload
    def __init__(self, bands: int) -> None: ...
    @overload
    def __init__(self, coefficients: ArrayLike) -> None: ...
    @property
    def bands(self) -> int: ...
    @property
    def coefficients(self) -> NDArray[np.float64]: ...
    @property
    def mean(self) -> NDArray[np.float64]: ...
    def __array__(self, *args: Any, **kwargs: Any) -> NDArray[np.float64]: ...
    def __call__(self, directions: ArrayLike) -> NDArray[np.float64]: ...
    def irradiance(self) -> SphericalHarmonics: ...
    def lambertian(self) -> SphericalHarmonics: ...
    def rotate(self, rotation: ArrayLike) -> SphericalHarmonics: ...
    def resized(self, bands: int) -> SphericalHarmonics: ...
    def lerp(self, other: SphericalHarmonics, t: float) -> SphericalHarmonics: ...
    def product(self, other: SphericalHarmonics, bands: int = 0) -> SphericalHarmonics: ...
    def minimum(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def dominant_light(self) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None: ...
    def window(self, window: _Window = "min-laplacian", width: float = 0.0) -> WindowResult: ...
    def __add__(self, other: SphericalHarmonics) -> SphericalHarmonics: ...
    def __radd__(self, other: Literal[0]) -> SphericalHarmonics: ...
    def __sub__(self, other: SphericalHarmonics) -> SphericalHarmonics: ...
    def __mul__(self, factor: ArrayLike) -> SphericalHarmonics: ...
    def __rmul__(self, factor: ArrayLike) -> SphericalHarmonics: ...
    def __truediv__(self, divisor: ArrayLike) -> SphericalHarmonics: ...
    def __neg__(self) -> SphericalHarmonics: ...
    def __eq__(self, other: object) -> bool: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int | slice) -> NDArray[np.float64]: ...
    def __iter__(self) -> Iterator[NDArray[np.float64]]: ...
    def __copy__(self) -> SphericalHarmonics: ...
    def __deepcopy__(self, memo: object) -> SphericalHarmonics: ...
    def __reduce__(self) -> tuple[type[SphericalHarmonics], tuple[NDArray[np.float64]]]: ...

class WindowResult:
    @property
    def harmonics(self) -> SphericalHarmonics: ...
    @property
    def parameter(self) -> float: ...
    @property
    def minimum_before(self) -> NDArray[np.float64]: ...
    @property
    def minimum_after(self) -> NDArray[np.float64]: ...
    @property
    def factors(self) -> list[float]: ...

def cosine_lobe(l: int) -> float: ...
def basis(directions: ArrayLike, bands: int = 3) -> NDArray[np.float64]: ...

# ---- Engines

class Convention:
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def right_handed(self) -> bool: ...
    @property
    def axes(self) -> str: ...
    @property
    def lat_long(self) -> str: ...
    @property
    def source(self) -> str: ...
    @property
    def from_welkin(self) -> NDArray[np.float64]: ...
    @property
    def faces_from_engine(self) -> NDArray[np.float64] | None: ...

class EngineLight:
    @property
    def engine(self) -> str: ...
    @property
    def form(self) -> str: ...
    @property
    def formula(self) -> str: ...
    @property
    def terms(self) -> dict[str, NDArray[np.float64]]: ...
    @property
    def vectors(self) -> dict[str, NDArray[np.float64]]: ...

def conventions() -> dict[str, Convention]: ...
def engine_light(radiance: SphericalHarmonics | ArrayLike, engine: _Engine, in_place: bool = False) -> EngineLight: ...

# ---- Pixels to coefficients

class PixelPolicy:
    def __init__(
        self,
        *,
        clamp: float | None = None,
        preserve_colour: bool = False,
        gamma: bool = False,
        nan: Literal["replace", "reject"] = "replace",
        infinity: Literal["replace", "reject"] = "replace",
        negative: Literal["keep", "replace", "reject"] = "keep",
    ) -> None: ...
    def __eq__(self, other: object) -> bool: ...

class PassRecord:
    @property
    def name(self) -> str: ...
    @property
    def action(self) -> _Action: ...
    @property
    def reason(self) -> str: ...
    @property
    def milliseconds(self) -> float: ...

class Diagnostics:
    @property
    def texels(self) -> int: ...
    @property
    def nans_replaced(self) -> int: ...
    @property
    def infinities_replaced(self) -> int: ...
    @property
    def negatives_replaced(self) -> int: ...
    @property
    def texels_clamped(self) -> int: ...
    @property
    def total_radiance(self) -> NDArray[np.float64]: ...
    @property
    def total_radiance_before_clamp(self) -> NDArray[np.float64]: ...
    @property
    def error_estimate(self) -> float: ...
    @property
    def passes(self) -> list[PassRecord]: ...

class Projection:
    @property
    def radiance(self) -> SphericalHarmonics: ...
    @property
    def irradiance(self) -> SphericalHarmonics: ...
    @property
    def diagnostics(self) -> Diagnostics: ...

class Irradiance:
    @property
    def harmonics(self) -> SphericalHarmonics: ...
    @property
    def cubemap(self) -> NDArray[np.float32] | None: ...
    @property
    def pixels(self) -> NDArray[np.float32] | None: ...
    def _repr_png_(self) -> bytes | None: ...

def project(
    pixels: _Pixels,
    *,
    bands: int = 3,
    quadrature: _Quadrature = "exact",
    target_size: int | None = None,
    policy: PixelPolicy | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> Projection: ...
def irradiance(
    light: _Pixels | SphericalHarmonics,
    *,
    size: int | None = None,
    method: _IrradianceMethod = "harmonics",
    bands: int = 3,
    quadrature: _Quadrature = "exact",
    target_size: int | None = None,
    policy: PixelPolicy | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> Irradiance: ...
def direct_irradiance(
    pixels: _Pixels,
    normals: ArrayLike,
    *,
    policy: PixelPolicy | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> NDArray[np.float64]: ...

# ---- Reflections

class ZonalLobe:
    @staticmethod
    def charlie(roughness: float) -> ZonalLobe: ...
    @staticmethod
    def lambert() -> ZonalLobe: ...
    @staticmethod
    def phong(power: float) -> ZonalLobe: ...
    @staticmethod
    def blinn(power: float) -> ZonalLobe: ...
    @staticmethod
    def from_function(value: Callable[[float], float], breaks: Sequence[float] = [0.0]) -> ZonalLobe: ...
    @staticmethod
    def from_spectrum(factors: Sequence[float] | NDArray[np.float64]) -> ZonalLobe: ...
    @property
    def roughness(self) -> float: ...
    def value(self, cosines: ArrayLike) -> NDArray[np.float64]: ...
    def spectrum(self, bands: int) -> NDArray[np.float64]: ...

class MipRecord:
    @property
    def size(self) -> int: ...
    @property
    def roughness(self) -> float: ...
    @property
    def lobe_roughness(self) -> float: ...
    @property
    def method(self) -> Literal["copy", "spectral", "reference", "stored", "near_far"]: ...
    @property
    def bands(self) -> int: ...
    @property
    def bright_texels(self) -> int: ...
    @property
    def error_estimate(self) -> float | None: ...
    @property
    def error_between(self) -> float | None: ...
    @property
    def mean(self) -> NDArray[np.float64]: ...
    @property
    def milliseconds(self) -> float: ...

class Chain:
    @property
    def levels(self) -> list[NDArray[np.float32]]: ...
    @property
    def pixels(self) -> NDArray[np.float32] | None: ...
    @property
    def size(self) -> int: ...
    @property
    def nbytes(self) -> int: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, level: SupportsIndex) -> NDArray[np.float32]: ...
    @overload
    def __getitem__(self, level: slice) -> list[NDArray[np.float32]]: ...
    def _repr_png_(self) -> bytes | None: ...

class Reflections(Chain):
    @property
    def mips(self) -> list[MipRecord]: ...
    @property
    def diagnostics(self) -> Diagnostics: ...
    @property
    def peak_bytes(self) -> int: ...

class BrdfTable:
    @property
    def values(self) -> NDArray[np.float32]: ...
    @property
    def model(self) -> _BrdfModel: ...
    def __array__(self, *args: Any, **kwargs: Any) -> NDArray[np.float32]: ...

class OctahedralMap:
    @property
    def levels(self) -> list[NDArray[np.float32]]: ...
    @property
    def size(self) -> int: ...
    @property
    def border(self) -> int: ...
    def __len__(self) -> int: ...

def prefilter(
    pixels: _Pixels,
    *,
    size: int = 256,
    mips: int | None = None,
    roughness: Sequence[float] | _Schedule | None = None,
    lobe_roughness: Sequence[float] | Literal["fitted"] | None = None,
    lobe: _Lobe = "ggx",
    spectra: Sequence[Sequence[float]] | None = None,
    method: _Method = "automatic",
    quality: _Quality = "normal",
    rms_error: float = 1e-3,
    maximum_error: float | None = None,
    lobes: Sequence[ZonalLobe] | None = None,
    policy: PixelPolicy | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> Reflections: ...
def reference_specular(
    pixels: _Pixels,
    lobe: float | ZonalLobe,
    directions: ArrayLike,
    *,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> NDArray[np.float64]: ...
def brdf_table(
    *,
    width: int = 64,
    height: int = 64,
    model: _BrdfModel = "split-sum",
    sheen: bool = True,
    progress: _Progress = None,
    threads: int | None = None,
) -> BrdfTable: ...
def build_mips(
    pixels: _Pixels,
    *,
    filter: _MipFilter = "solid-angle",
    levels: int | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> Chain: ...
def mip_roughness(schedule: _Schedule, mips: int, size: int) -> list[float]: ...
def fitted_mip_roughness(schedule: _Schedule, mips: int, size: int) -> list[float]: ...
def mip_for_roughness(table: Sequence[float], roughness: float) -> float: ...
def to_octahedral(
    light: Chain | SphericalHarmonics,
    *,
    size: int = 256,
    levels: int = 1,
    border: int = 0,
    progress: _Progress = None,
    threads: int | None = None,
) -> OctahedralMap: ...
def octahedral_encode(directions: ArrayLike) -> NDArray[np.float64]: ...
def octahedral_decode(places: ArrayLike) -> NDArray[np.float64]: ...

# ---- All of it, and plans

class Bake:
    @property
    def background(self) -> Chain | None: ...
    @property
    def specular(self) -> Reflections | None: ...
    @property
    def octahedral(self) -> OctahedralMap | None: ...
    @property
    def irradiance(self) -> NDArray[np.float32] | None: ...
    @property
    def irradiance_record(self) -> MipRecord | None: ...
    @property
    def radiance(self) -> SphericalHarmonics | None: ...
    @property
    def brdf(self) -> BrdfTable | None: ...
    @property
    def diagnostics(self) -> Diagnostics: ...
    @property
    def peak_bytes(self) -> int: ...
    @property
    def pixels(self) -> NDArray[np.float32] | None: ...
    def _repr_png_(self) -> bytes | None: ...

class ManyLights:
    @property
    def coefficients(self) -> NDArray[np.float64]: ...
    @property
    def specular(self) -> list[NDArray[np.float16] | NDArray[np.float32]]: ...
    @property
    def diagnostics(self) -> Diagnostics: ...
    @property
    def peak_bytes(self) -> int: ...
    @property
    def values_clamped(self) -> int: ...
    def __len__(self) -> int: ...

class PlannedPass:
    @property
    def name(self) -> str: ...
    @property
    def action(self) -> _Action: ...
    @property
    def reason(self) -> str: ...
    @property
    def bytes(self) -> int: ...

class Plan:
    @property
    def source(self) -> str: ...
    @property
    def passes(self) -> list[PlannedPass]: ...
    @property
    def result_bytes(self) -> int: ...
    @property
    def working_bytes(self) -> int: ...

def bake(
    pixels: _Pixels,
    *,
    background: bool | _Background = True,
    specular: bool | _Specular = True,
    octahedral: bool | _Octahedral = False,
    irradiance: bool | _IrradianceCubemap = True,
    brdf: bool | _Brdf = True,
    bands: int = 3,
    quality: _Quality = "normal",
    policy: PixelPolicy | None = None,
    memory_limit: int = 8589934592,
    plan: Plan | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> Bake: ...
def project_many(
    probes: _Array | Sequence[_Pixels],
    *,
    bands: int = 3,
    quadrature: _Quadrature = "exact",
    target_size: int | None = None,
    policy: PixelPolicy | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> ManyLights: ...
def bake_many(
    probes: _Array | Sequence[_Pixels],
    *,
    size: int = 256,
    mips: int | None = None,
    roughness: Sequence[float] | _Schedule | None = None,
    lobe_roughness: Sequence[float] | Literal["fitted"] | None = None,
    lobe: _Lobe = "ggx",
    spectra: Sequence[Sequence[float]] | None = None,
    method: _Method = "automatic",
    quality: _Quality = "normal",
    rms_error: float = 1e-3,
    maximum_error: float | None = None,
    policy: PixelPolicy | None = None,
    bands: int = 3,
    type: Literal["float16", "float32"] = "float16",
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> ManyLights: ...
def plan(
    pixels: _Pixels | tuple[int, ...],
    *,
    needs: _Needs | None = None,
    background: bool | _Background = True,
    specular: bool | _Specular = True,
    octahedral: bool | _Octahedral = False,
    irradiance: bool | _IrradianceCubemap = True,
    brdf: bool | _Brdf = True,
    bands: int = 3,
    quality: _Quality = "normal",
    policy: PixelPolicy | None = None,
    memory_limit: int = 8589934592,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> Plan: ...

# ---- Picking directions

class ImportanceTable:
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def function(self) -> NDArray[np.float32]: ...
    @property
    def row_cdf(self) -> NDArray[np.float32]: ...
    @property
    def column_cdf(self) -> NDArray[np.float32]: ...
    @property
    def integral(self) -> float: ...
    def sample(self, across: ArrayLike, down: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def density(self, directions: ArrayLike) -> NDArray[np.float64]: ...
    def alias(
        self, *, progress: _Progress = None, threads: int | None = None
    ) -> tuple[NDArray[np.void], NDArray[np.void]]: ...
    def pyramid(self, *, progress: _Progress = None, threads: int | None = None) -> list[NDArray[np.float32]]: ...
    def variance(
        self,
        pixels: _Pixels,
        *,
        weight: _Weight = "luminance",
        policy: PixelPolicy | None = None,
        layout: _Layout = None,
        encoding: _Encoding = None,
        read: _Read | None = None,
        progress: _Progress = None,
        threads: int | None = None,
    ) -> tuple[float, float]: ...

def importance_table(
    pixels: _Pixels,
    *,
    width: int = 0,
    height: int = 0,
    weight: _Weight = "luminance",
    mis_compensation: bool = False,
    policy: PixelPolicy | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> ImportanceTable: ...

# ---- Grids of light probes

_ProbeLayout: TypeAlias = Literal["three", "unity-l2", "unity-l1", "plain", "bevy", "rtxgi"]

class ProbeGrid:
    @property
    def counts(self) -> tuple[int, int, int]: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def spacing(self) -> NDArray[np.float64]: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def coefficients(self) -> NDArray[np.float64]: ...
    @property
    def validity(self) -> NDArray[np.float32]: ...
    @property
    def passes(self) -> NDArray[np.uint8]: ...
    @property
    def distances(self) -> NDArray[np.float32]: ...
    @property
    def sky(self) -> NDArray[np.float64]: ...
    @property
    def offsets(self) -> NDArray[np.float64] | None: ...
    @offsets.setter
    def offsets(self, arg1: ArrayLike | None) -> None: ...
    def irradiance(
        self,
        positions: ArrayLike,
        normals: ArrayLike,
        *,
        visibility: bool = True,
        facing: bool = True,
        validity: bool = True,
        normal_bias: float = 0.2,
    ) -> NDArray[np.float64]: ...
    def relight(self, before: SphericalHarmonics, after: SphericalHarmonics, dilation_passes: int = 4) -> None: ...
    def pack(self, layout: _ProbeLayout) -> dict[str, NDArray[np.float16]]: ...
    def write(self, path: _Path, layouts: Sequence[_ProbeLayout] = []) -> None: ...
    def __len__(self) -> int: ...

def bake_probes(
    cubemaps: _Array | Sequence[_Pixels],
    depths: ArrayLike | None = None,
    *,
    counts: Sequence[int],
    origin: ArrayLike = (0.0, 0.0, 0.0),
    spacing: ArrayLike = (1.0, 1.0, 1.0),
    offsets: ArrayLike | None = None,
    bands: int = 3,
    quadrature: _Quadrature = "exact",
    target_size: int | None = None,
    policy: PixelPolicy | None = None,
    near_share: float = 0.1,
    valid_share: float = 0.75,
    distance_size: int = 8,
    distance_power: int = 50,
    distance_limit: float = 0.0,
    dilation_passes: int = 4,
    environment_bands: int = 0,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> ProbeGrid: ...
def relocate_probes(
    depths: ArrayLike,
    *,
    counts: Sequence[int],
    origin: ArrayLike = (0.0, 0.0, 0.0),
    spacing: ArrayLike = (1.0, 1.0, 1.0),
    offsets: ArrayLike | None = None,
    back_share: float = 0.25,
    clearance: float = 0.12,
    farthest: float = 0.45,
    progress: _Progress = None,
    threads: int | None = None,
) -> NDArray[np.float64]: ...
def read_probes(path: _Path) -> ProbeGrid: ...
def probe_sampling_code(language: Literal["glsl", "hlsl", "wgsl", "cpp"]) -> str: ...

# ---- Skies

class SkyCurve:
    @property
    def bands(self) -> int: ...
    @property
    def nbytes(self) -> int: ...
    def __call__(self, sun: ArrayLike) -> SphericalHarmonics: ...
    def sun_irradiance(self, sun: ArrayLike) -> NDArray[np.float64]: ...

class Sky:
    @property
    def name(self) -> str: ...
    @property
    def altitude(self) -> float: ...
    @property
    def tables(self) -> _SkyTables: ...
    def at_altitude(self, altitude: float, ground: bool = True) -> Sky: ...
    def radiance(self, directions: ArrayLike, sun: ArrayLike) -> NDArray[np.float32]: ...
    def sun(self, sun: ArrayLike) -> _Sun: ...
    def irradiance(self, sun: ArrayLike) -> NDArray[np.float64]: ...
    def harmonics(
        self,
        sun: ArrayLike,
        *,
        bands: int = 3,
        quadrature: _SkyQuadrature = "gauss-split",
        zeniths: int = 16,
        azimuths: int = 16,
    ) -> SphericalHarmonics: ...
    def curve(
        self,
        *,
        bands: int = 3,
        nodes: int = 256,
        quadrature: _SkyQuadrature = "gauss-split",
        zeniths: int = 32,
        azimuths: int = 32,
        progress: _Progress = None,
        threads: int | None = None,
    ) -> SkyCurve: ...
    def cubemap(
        self,
        sun: ArrayLike,
        size: int,
        *,
        sun_disc: bool = False,
        progress: _Progress = None,
        threads: int | None = None,
    ) -> NDArray[np.float32]: ...
    def lat_long(
        self,
        sun: ArrayLike,
        height: int,
        *,
        sun_disc: bool = False,
        progress: _Progress = None,
        threads: int | None = None,
    ) -> NDArray[np.float32]: ...
    def save(self, path: _Path) -> None: ...

def sky(
    planet: Literal["earth", "earth-bruneton", "earth-hillaire", "mars"] = "earth",
    *,
    altitude: float = 0.0,
    aerosol: Literal["clear", "hazy", "dusty", "polluted"] = "clear",
    wavelengths: Sequence[float] | None = None,
    ground_albedo: float | None = None,
    night_zenith_luminance: float = 0.0,
    ground: bool = True,
    colour: Literal["spectral", "linear-srgb"] = "linear-srgb",
    table_layout: Literal["full", "compact"] = "full",
    heights: int = 32,
    view_zeniths: int = 64,
    sun_zeniths: int = 64,
    sun_angles: int = 8,
    orders: int = 4,
    minimum_sun_elevation: float = -30.0,
    memory_limit: int = 4294967296,
    progress: _Progress = None,
    threads: int | None = None,
) -> Sky: ...
def load_sky(file: _File, *, altitude: float = 0.0, ground: bool = True) -> Sky: ...
def sun_direction(elevation: float, azimuth: float = 0.0) -> NDArray[np.float64]: ...
def sun_position(
    date: str | float | datetime,
    latitude: float,
    longitude: float,
    *,
    north: float = 180.0,
    refraction: bool = False,
    pressure: float = 1010.0,
    temperature: float = 10.0,
) -> _SunPosition: ...

# ---- Files

class Environment:
    @property
    def pixels(self) -> NDArray[np.float32]: ...
    @property
    def info(self) -> _Info: ...
    def __array__(self, *args: Any, **kwargs: Any) -> NDArray[np.float32]: ...
    def _repr_png_(self) -> bytes | None: ...

class Texture(Chain):
    @property
    def format(self) -> str: ...
    @property
    def metadata(self) -> dict[str, str]: ...

def read(
    file: _File,
    *,
    layout: _FileLayout = "automatic",
    part: str = "",
    layer: str = "",
    level: int = 0,
    element: int = 0,
    transfer: _Transfer = "automatic",
    primaries: _Primaries = "rec709",
    memory_limit: int = 8589934592,
    progress: _Progress = None,
    threads: int | None = None,
) -> Environment: ...
def inspect(
    file: _File,
    *,
    layout: _FileLayout = "automatic",
    part: str = "",
    layer: str = "",
    level: int = 0,
    element: int = 0,
    transfer: _Transfer = "automatic",
    primaries: _Primaries = "rec709",
    memory_limit: int = 8589934592,
) -> _Info: ...
def measure(
    file: _File,
    *,
    layout: _FileLayout = "automatic",
    part: str = "",
    layer: str = "",
    level: int = 0,
    element: int = 0,
    transfer: _Transfer = "automatic",
    primaries: _Primaries = "rec709",
    memory_limit: int = 8589934592,
    progress: _Progress = None,
    threads: int | None = None,
) -> _Statistics: ...
def write(
    path: _Path,
    pixels: _Pixels,
    layout: _FileLayout = "automatic",
    type: _SampleType = "automatic",
    *,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> _Written: ...
def encode(
    name: str,
    pixels: _Pixels,
    layout: _FileLayout = "automatic",
    type: _SampleType = "automatic",
    *,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> bytes: ...
def read_texture(
    file: _File, *, memory_limit: int = 8589934592, progress: _Progress = None, threads: int | None = None
) -> Texture: ...
def write_texture(
    path: _Path,
    texture: Chain | Sequence[_Array] | _Array | BrdfTable | OctahedralMap,
    *,
    format: _TexelFormat = "rgba16f",
    supercompression: Literal["none", "zlib", "zstd"] = "none",
    bc6h_effort: Literal["fast", "normal", "slow"] = "normal",
    astc_effort: Literal["fastest", "fast", "medium", "thorough"] = "medium",
    metadata: Mapping[str, str] | None = None,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> _Written: ...
def write_env(path: _Path, specular: Chain, radiance: SphericalHarmonics | ArrayLike) -> _Written: ...

# ---- Images

def to_cubemap(
    pixels: _Pixels,
    size: int,
    *,
    rotation: ArrayLike | None = None,
    filter: _Resampling = "area",
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> NDArray[np.float32]: ...
def to_lat_long(
    pixels: _Pixels,
    height: int,
    *,
    rotation: ArrayLike | None = None,
    filter: _Resampling = "area",
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> NDArray[np.float32]: ...
def rotation_about_y(degrees: float) -> NDArray[np.float64]: ...
def preview(
    pixels: _Pixels,
    height: int = 128,
    exposure: float = 0.0,
    *,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> bytes: ...
def tone_mapped(
    pixels: _Pixels,
    height: int = 128,
    exposure: float = 0.0,
    *,
    layout: _Layout = None,
    encoding: _Encoding = None,
    read: _Read | None = None,
    progress: _Progress = None,
    threads: int | None = None,
) -> NDArray[np.float32]: ...
