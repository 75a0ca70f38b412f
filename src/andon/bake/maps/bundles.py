"""Bundles that are made when somebody reads them: a film has thousands, memory holds a few.

What a bundle is made of has a name too, and making it again gives the same bytes: so each is made
once to be named, and again if it is needed and was dropped in between.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping

from andon.bake.tasks.model import Bundle, bundle_digest

__all__ = ["Bundles"]

# Bytes of bundles that are kept: some three of a photographed room, each 0.3 GB as text.
KEPT_BYTES = 2**30


class Bundles(Mapping[str, Bundle]):
    """`bundle_digest` → bundle, of all that were added.

    Parameters
    ----------
    kept_bytes : how much is kept of what was made; the last one always is.
    """

    def __init__(self, kept_bytes: int = KEPT_BYTES) -> None:
        self._kept_bytes = kept_bytes
        self._makers: dict[str, Callable[[], Bundle]] = {}
        self._named: dict[str, str] = {}
        self._kept: OrderedDict[str, Bundle] = OrderedDict()
        self._sizes: dict[str, int] = {}

    def add(self, source: str, make: Callable[[], Bundle], /) -> str:
        """The name of what `make` gives; `source` names what that depends on."""
        if source not in self._named:
            bundle = make()
            name = bundle_digest(bundle)
            self._named[source] = name
            self._makers.setdefault(name, make)
            self._keep(name, bundle)
        return self._named[source]

    def made(self, name: str, /) -> Bundle:
        """The files of a bundle, now. Raises `KeyError` for one that was never added."""
        if name in self._kept:
            self._kept.move_to_end(name)
            return self._kept[name]
        bundle = self._makers[name]()
        self._keep(name, bundle)
        return bundle

    def __getitem__(self, name: str, /) -> Bundle:
        """The bundle; it is made when its files are asked for."""
        if name not in self._makers:
            raise KeyError(name)
        return _Later(self, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)

    def _keep(self, name: str, bundle: Bundle) -> None:
        self._kept[name] = bundle
        self._kept.move_to_end(name)
        self._sizes[name] = sum(map(len, bundle.values()))
        while len(self._kept) > 1 and sum(self._sizes[n] for n in self._kept) > self._kept_bytes:
            self._kept.popitem(last=False)


class _Later(Mapping[str, bytes]):
    """A bundle that is made when its files are asked for, and not held; it travels as a dict."""

    def __init__(self, bundles: Bundles, name: str) -> None:
        self._bundles, self._name = bundles, name

    def __getitem__(self, name: str, /) -> bytes:
        return self._bundles.made(self._name)[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._bundles.made(self._name))

    def __len__(self) -> int:
        return len(self._bundles.made(self._name))

    def __reduce__(self) -> tuple[type[dict[str, bytes]], tuple[dict[str, bytes]]]:
        return dict, (dict(self._bundles.made(self._name)),)
