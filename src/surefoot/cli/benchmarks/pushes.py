"""``surefoot bench pushes``: an ensemble of pushed walks."""

from __future__ import annotations

from surefoot.cli.output import Say, answer


def answer_pushes(say: Say, *, as_json: bool) -> None:
    """Walk pushed missions and answer whether every log tells the truth and small pushes are absorbed."""
    from surefoot.missions.bench.pushes import push_ensemble

    rows = push_ensemble(progress=say)
    met = all(row.refused == 0 for row in rows)
    lines = [
        "Random pushes at any instant on the two-room scene, 20 seeds x 60 steps, every tenth step pushed",
        "  ahead [m/s]  sideways [m/s]  pushes  in region  by step  falls  walks without a fall  logs refused",
        *(
            f"  {row.size_mps:<11g}  {row.side_size_mps:<14g}  {row.pushes:<6}  {row.share(row.in_region):<9}  "
            f"{row.share(row.by_step):<7}  {row.share(row.falls):<5}  {row.whole:<20}  {row.refused}"
            for row in rows
        ),
    ]
    answer({"rows": rows, "met": met}, lines, yes=met, as_json=as_json)
