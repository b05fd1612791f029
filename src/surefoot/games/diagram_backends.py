"""Opens a manager of decision diagrams on the back end that is asked for; only that one is loaded."""

from __future__ import annotations

from surefoot.errors import InputError
from surefoot.games.diagrams import Backend, Diagrams


def diagrams(variables: int, *, backend: Backend = "oxidd", node_limit: int | None = None) -> Diagrams:
    """Return a manager with so many variables.

    Args:
        variables: how many; variable 0 is the top of the order.
        backend: ``oxidd`` (always there) or ``cudd`` (needs the package dd).
        node_limit: the most nodes alive at once; None for the default, about 2 GB.

    Raises:
        BackendMissing: if the back end is not installed.
    """
    if backend == "oxidd":
        from surefoot.games.diagrams_oxidd import OxiddDiagrams

        return OxiddDiagrams(variables, node_limit)
    if backend == "cudd":
        from surefoot.games.diagrams_cudd import CuddDiagrams

        return CuddDiagrams(variables, node_limit)
    raise InputError(f"there is no decision diagram back end {backend!r}; there are: oxidd, cudd")
