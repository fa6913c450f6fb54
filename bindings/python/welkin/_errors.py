"""The exceptions of the library's error codes."""
import errno


class Error(Exception):
    """What the library refuses or fails at. `code` is for programs, the message for people."""

    code = "invalid_argument"


class InvalidArgument(Error, ValueError):
    """An array or an option that no call could accept."""

    code = "invalid_argument"


class RejectedPixel(Error, ValueError):
    """A texel that the policy rejects; the message names face, row and column."""

    code = "rejected_pixel"


class FileAccess(Error, OSError):
    """A file that cannot be opened, read or written."""

    code = "file_access"


class FileNotFound(FileAccess, FileNotFoundError):
    """A file that is not there."""


class CorruptFile(Error, ValueError):
    """A file that breaks its own format, or ends too early."""

    code = "corrupt_file"


class UnsupportedFile(Error, ValueError):
    """A sound file of a kind that is not read, or whose layout is unclear."""

    code = "unsupported_file"


class LimitExceeded(Error, MemoryError):
    """What would need more memory than the stated limit."""

    code = "limit_exceeded"


class Cancelled(Error):
    """The caller cancelled the call."""

    code = "cancelled"


class Replaced(Error):
    """A newer request took this job's place."""

    code = "replaced"


class QueueFull(Error):
    """A worker at its limits refused this job."""

    code = "queue_full"


class Stopped(Error):
    """The worker ended before this job was done."""

    code = "stopped"


_BY_CODE = {
    kind.code: kind
    for kind in (
        InvalidArgument,
        RejectedPixel,
        FileAccess,
        CorruptFile,
        UnsupportedFile,
        LimitExceeded,
        Cancelled,
        Replaced,
        QueueFull,
        Stopped,
    )
}
_NOT_THERE = "there is no such"


def error_of(code, message):
    """The exception that the extension throws for an error of the library's."""
    kind = _BY_CODE[code]
    if kind is FileAccess and _NOT_THERE in message:
        kind = FileNotFound
    error = kind(message)
    if kind is FileNotFound:
        error.errno = errno.ENOENT
    return error
