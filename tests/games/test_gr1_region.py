"""The winning region is the one of brute force, state by state."""

from __future__ import annotations

import random

import pytest
from gr1_grid_oracle import Grid, random_game

from surefoot.games import EnvDeadEnd
from surefoot.games.region import winning_region


@pytest.mark.parametrize("env_dead_end", ["wins", "loses"])
def test_the_region_of_brute_force(env_dead_end: EnvDeadEnd) -> None:
    sizes = set()
    for seed in range(40):
        spec = random_game(random.Random(seed))
        grid, region = Grid.of(spec), winning_region(spec, env_dead_end=env_dead_end)
        names = [variable.name for variable in spec.variables]
        found = [region.contains(dict(zip(names, state.tolist(), strict=True))) for state in grid.states]
        assert found == grid.winning(env_dead_end).tolist()
        sizes.add(sum(found))
    assert len(sizes) > 5


def test_a_value_out_of_range_is_refused() -> None:
    spec = random_game(random.Random(1))
    with pytest.raises(ValueError, match="a is one of"):
        winning_region(spec).contains({})
