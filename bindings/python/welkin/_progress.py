"""What `progress=True` shows: a bar of tqdm's where that is installed, else nothing."""


class Bar:
    """Receives the fraction of the work that is done, 0 to 1."""

    def __init__(self, what):
        try:
            from tqdm.auto import tqdm
        except ImportError:
            self._bar = None
            return
        self._bar = tqdm(total=100, desc=what, unit="%", bar_format="{l_bar}{bar}| {elapsed} < {remaining}")

    def __call__(self, share):
        if self._bar is not None:
            self._bar.update(int(100 * share) - self._bar.n)

    def close(self):
        if self._bar is not None:
            self._bar.close()
