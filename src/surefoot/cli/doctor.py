"""``surefoot doctor``: what is installed, what the machine has, what is missing and how to get it."""

from __future__ import annotations

from surefoot.cli.output import AsJson, answer, facts


def doctor(as_json: AsJson = False) -> None:
    """Show versions, cores, memory and caches, and say what is missing and how to get it.

    Examples:
      surefoot doctor
      surefoot doctor --json

    Exit code 0: what the core needs is there; 1: something of it is missing.
    """
    from surefoot.cli.surroundings import examine

    found = examine()
    lines = [
        "Versions",
        *facts({name: version or "MISSING" for name, version in found.versions.items()}),
        "Machine",
        *facts(
            {
                "cores": found.cores,
                "memory [MB]": found.memory_mb,
                "OPENBLAS_NUM_THREADS": found.openblas_threads or "not set (1 is best while planning)",
            }
        ),
        "Compiled code",
        *facts(
            {
                "cache": found.cache_folder,
                "writable": found.cache_writable,
                "warm": found.cache_warm or "no (the first plan compiles, which takes about a minute)",
            }
        ),
        "Optional parts",
        *(facts({extra.name: extra.missing_text for extra in found.extras}) or ["  none in this version"]),
        "Everything that the core needs is there." if found.complete else f"Missing: {', '.join(found.advice)}",
    ]
    answer(found, lines, yes=found.complete, as_json=as_json)
