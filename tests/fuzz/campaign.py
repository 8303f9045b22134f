"""The long search for input that breaks the socket: `python -m tests.fuzz.campaign --minutes 10`."""

import re
import subprocess
import sys
from pathlib import Path
from random import SystemRandom

import click

from tests.fuzz.live import besiege

ROOM = Path("build/fuzz")

SHARES = {"framing": 0.25, "daemon": 0.5}
"""Of the time; the rest is for a daemon in real time."""

MOST_BYTES, MOST_MEMORY, MOST_SECONDS = 4096, 2048, 20
"""Of one input; MiB of the search; s for one input, after which it counts as hung."""

PULSE = re.compile(r"#(\d+)\s+(INITED|NEW|REDUCE|pulse|DONE)\s+cov: (\d+).*corp: (\d+)")


def search(target: str, seconds: float, seed: int) -> bool:
    """Search for a while; whether nothing was found."""
    room = ROOM / target
    for name in ("corpus", "history", "crashes"):
        (room / name).mkdir(parents=True, exist_ok=True)
    options = [
        f"-max_total_time={seconds:.0f}",
        f"-seed={seed}",
        f"-artifact_prefix={room / 'crashes'}/",
        f"-max_len={MOST_BYTES}",
        f"-rss_limit_mb={MOST_MEMORY}",
        f"-timeout={MOST_SECONDS}",
        "-print_final_stats=1",
    ]
    command = [sys.executable, "-m", "tests.fuzz.guided", target, str(room / "corpus"), *options]
    with (room / "log").open("w") as log:
        done = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT)
    said = (room / "log").read_text(errors="replace")
    _report(target, said)
    if done.returncode:
        click.echo(
            f"  BROKEN (exit code {done.returncode}): {room}/log, {room}/crashes, {room}/history", err=True
        )
    return done.returncode == 0


def _report(target: str, said: str) -> None:
    pulses = PULSE.findall(said)
    if not pulses:
        click.echo(f"{target}: it did not even begin", err=True)
        return
    begun = next((pulse for pulse in pulses if pulse[1] == "INITED"), pulses[0])
    runs, _, coverage, corpus = pulses[-1]
    click.echo(f"{target}: {runs} executions; coverage {begun[2]} → {coverage}, corpus {begun[3]} → {corpus}")


@click.command()
@click.option("--minutes", type=click.FloatRange(min=0.1), default=10.0)
@click.option("--seed", type=click.IntRange(min=1, max=2**31), help="Of an earlier search.")
def main(minutes: float, seed: int | None) -> None:
    """Search for input that breaks the framing or the daemon, then attack a real one; keeps what it finds."""
    seed = seed or SystemRandom().randint(1, 2**31)
    click.echo(f"seed {seed}; what is found stays in {ROOM}")
    held = [search(target, 60 * minutes * share, seed) for target, share in SHARES.items()]
    toll = besiege(60 * minutes * (1 - sum(SHARES.values())), seed)
    click.echo(
        f"live: {toll.attacks} connections in {toll.seconds:.0f} s; {toll.missed:g} ticks missed beside "
        f"{toll.ticks:g} ({toll.missed_idle:g} before, in a tenth of the time); "
        f"{toll.busy:.0%} of a core; {toll.grown:+} KiB"
    )
    raise SystemExit(0 if all(held) else 1)


if __name__ == "__main__":
    main()
