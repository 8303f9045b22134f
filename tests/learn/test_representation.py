import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bentod.config_learn import Learn, RepresentationTable, Tiles
from bentod.errors import ConfigError
from bentod.frames import JointSpec
from bentod.learn.expression import Vocabulary
from bentod.learn.representation import StateCoding, codings, state_coding
from bentod.learn.signals import Declared, Signals
from bentod.learn.tiles import TileCoder
from bentod.learn.traces import HistoryTraces
from tests.learn.arm_features import ArmFeatures

LIMITS = [(-1.0, 1.0), (0.5, 2.5)]


@given(st.lists(st.floats(0, 1), min_size=1, max_size=50), st.floats(0, 0.999))
def test_a_trace_is_the_decaying_sum_of_what_was_seen(signal: list[float], decay: float) -> None:
    traces = HistoryTraces(decay)
    for theta in signal:
        (trace,) = traces.step([theta])
    weights = [(1 - decay) * decay**age for age in range(len(signal) - 1)]
    newest_first = signal[:0:-1]
    expected = sum(w * x for w, x in zip(weights, newest_first, strict=True))
    assert trace == pytest.approx(expected + decay ** (len(signal) - 1) * signal[0])


def test_a_trace_starts_where_the_signal_is() -> None:
    traces = HistoryTraces(0.99)
    assert traces.step([0.3, 0.8]) == pytest.approx([0.3, 0.8])
    assert traces.step([0.4, 0.8]) == pytest.approx([0.301, 0.8])
    traces.restart()
    assert traces.step([0.4, 0.1]) == pytest.approx([0.4, 0.1])


@pytest.mark.parametrize("decay", [-0.1, 1.0])
def test_a_decay_out_of_range_is_refused(decay: float) -> None:
    with pytest.raises(ValueError, match="at least 0 and below 1"):
        HistoryTraces(decay)


def test_the_thesis_has_2049_features_of_which_101_are_active() -> None:
    representation = ArmFeatures(LIMITS)
    assert (representation.size, representation.active) == (2049, 101)
    features = representation.features([0.0, 1.0])
    assert 90 < len(features) <= 101


def test_the_bias_is_the_last_feature_and_always_active() -> None:
    representation = ArmFeatures(LIMITS)
    rng = np.random.default_rng(1)
    for positions in rng.uniform(-3, 3, (50, 2)).tolist():
        features = representation.features(positions)
        assert features[-1] == 2048
        assert (np.diff(features) > 0).all()


def test_angles_and_their_traces_are_tiled_after_normalising_over_the_limits() -> None:
    representation = ArmFeatures(LIMITS, tilings=16, memory=512, trace_decay=0.75)
    representation.features([-1.0, 2.5])
    features = representation.features([0.0, 2.0])
    tiles = TileCoder(4, tilings=16, memory=512).encode([0.5, 0.75, 0.125, 0.9375])
    assert features.tolist() == [*tiles.tolist(), 512]


def test_a_joint_beyond_its_limit_looks_like_one_at_the_limit() -> None:
    beyond = ArmFeatures(LIMITS).features([5.0, 0.0])
    at_the_limit = ArmFeatures(LIMITS).features([1.0, 0.5])
    assert beyond.tolist() == at_the_limit.tolist()


def test_the_same_place_looks_different_when_it_is_reached_from_elsewhere() -> None:
    from_left, from_right = ArmFeatures(LIMITS, trace_decay=0.9), ArmFeatures(LIMITS, trace_decay=0.9)
    from_left.features([-1.0, 1.0])
    from_right.features([1.0, 1.0])
    assert from_left.features([0.0, 1.0]).tolist() != from_right.features([0.0, 1.0]).tolist()


def test_after_a_restart_the_past_is_forgotten() -> None:
    representation = ArmFeatures(LIMITS, trace_decay=0.9)
    fresh = representation.features([0.0, 1.0]).tolist()
    representation.features([1.0, 1.0])
    representation.restart()
    assert representation.features([0.0, 1.0]).tolist() == fresh


def test_a_position_that_is_not_finite_is_refused_and_leaves_no_trace() -> None:
    representation = ArmFeatures(LIMITS, trace_decay=0.9)
    before = representation.features([0.0, 1.0]).tolist()
    with pytest.raises(ValueError, match="finite"):
        representation.features([float("nan"), 1.0])
    assert representation.features([0.0, 1.0]).tolist() == before


SPECS = tuple(JointSpec(f"j{i}", low, high, 1.0, low, {}) for i, (low, high) in enumerate(LIMITS))
EIGHT = Declared({f"p{i}": (0.0, 1.0) for i in range(8)} | {"force": (-3.0, 2.0), "heat": None})
WORDS = Vocabulary(EIGHT, {"push": "norm(force)"})
INPUTS = tuple(f"p{i}" for i in range(8))


def coded(*tiles: Tiles, raw: tuple[str, ...] = (), bias: bool = True) -> StateCoding:
    table = RepresentationTable(name="x", tiles=tiles, raw=raw, bias=bias)
    return state_coding(table, WORDS, "learn.representations.0")


@settings(max_examples=20)
@given(st.lists(st.tuples(st.floats(-1.5, 1.5), st.floats(0, 3)), min_size=1, max_size=8))
def test_the_arm_is_tiled_in_one_piece_angles_first_then_their_traces(
    journey: list[tuple[float, float]],
) -> None:
    arm, traces, tiles = (
        ArmFeatures(LIMITS, trace_decay=0.9),
        HistoryTraces(0.9),
        TileCoder(4, 100, memory=2048),
    )
    assert (arm.size, arm.active, arm.coding.apart) == (2049, 101.0, (2048,))
    for positions in journey:
        scaled = zip(positions, LIMITS, strict=True)
        angles = [min(max((x - low) / (high - low), 0.0), 1.0) for x, (low, high) in scaled]
        expected = tiles.encode(angles + traces.step(angles))
        assert arm.features(positions).tolist() == [*expected.tolist(), 2048]


def test_the_second_layer_of_the_thesis_has_9397_features() -> None:
    """Thesis 4.5.2: 8 predictions alone and in 28 pairs, each with 3 tilings of 0.5 and 6 of 0.17."""
    tiles = [
        Tiles(inputs=INPUTS, combine=combine, tilings=tilings, width=width)
        for combine in ("each", "pairs")
        for tilings, width in ((3, 0.5), (6, 0.17))
    ]
    coding = coded(*tiles)
    assert coding.size == 9397
    assert coding.active == 36 * 9 + 1
    assert coding.binary
    features = coding.encode(np.linspace(0, 1, 8))
    assert len(features) == coding.active
    assert features[-1] == 9396


def test_each_coding_has_a_region_of_its_own_in_the_order_of_the_table() -> None:
    hashed = Tiles(inputs=("p0", "p1", "p2"), combine="pairs", tilings=4, memory=64)
    exact = Tiles(inputs=("p3",), tilings=4, width=0.5)
    again = Tiles(inputs=("p1", "p3"), tilings=4, memory=64)
    coding = coded(hashed, exact, again)
    assert coding.inputs == ("p0", "p1", "p2", "p3")
    a, b, c, d = (0.1, 0.7, 0.4, 0.9)
    pair, single = TileCoder(2, 4, memory=64), TileCoder(1, 4, 0.5, memory=0)
    expected = [
        *pair.encode([a, b]),
        *(pair.encode([a, c]) + 64),
        *(pair.encode([b, c]) + 128),
        *(single.encode([d]) + 192),
        *(pair.encode([b, d]) + 192 + 12),
        192 + 12 + 64,
    ]
    assert coding.encode(np.array([a, b, c, d])).tolist() == expected
    assert coding.size == 192 + 12 + 64 + 1


@settings(max_examples=30)
@given(st.lists(st.floats(-0.5, 1.5), min_size=3, max_size=3))
def test_dense_features_are_those_that_are_active(point: list[float]) -> None:
    coding = coded(Tiles(inputs=("p0", "p1", "p2"), tilings=16, memory=32))
    inputs = np.array(point)
    assert np.flatnonzero(coding.dense(inputs)).tolist() == coding.encode(inputs).tolist()
    assert coding.encode(inputs)[-1] == 32


def test_raw_inputs_are_features_between_the_tiles_and_the_bias() -> None:
    coding = coded(Tiles(inputs=("p0",), tilings=2), raw=("force", "1 - p0", "heat"))
    phi = coding.dense(np.array([0.25, -2.0, 0.75, 40.0]))
    assert coding.inputs == ("p0", "force", "1 - p0", "heat")
    assert phi[-4:].tolist() == [-2.0, 0.75, 40.0, 1.0]
    assert phi[:-4].sum() == 2
    assert not coding.binary
    assert coding.active == 2 + 9 + 1 + 1 + 1
    with pytest.raises(ValueError, match="take them dense"):
        coding.encode(np.zeros(4))


def test_the_weak_features_of_the_thesis_are_bias_signal_and_its_complement() -> None:
    coding = coded(raw=("p0", "1 - p0"))
    assert coding.dense(np.array([0.25, 0.75])).tolist() == [0.25, 0.75, 1.0]
    assert coding.size == coding.active == 3


def test_without_a_bias_there_is_none() -> None:
    coding = coded(Tiles(inputs=("p0",), tilings=2, memory=8), bias=False)
    assert (coding.size, coding.active, coding.apart) == (8, 2.0, ())


def test_stars_stand_for_many_inputs() -> None:
    assert coded(Tiles(inputs=("p*",), combine="each")).inputs == INPUTS


def test_what_is_said_twice_is_one_input_and_definitions_are_written_out() -> None:
    coding = coded(Tiles(inputs=("push", "p0")), Tiles(inputs=("norm(force)", "p1")))
    assert coding.inputs == ("push", "p0", "p1")
    assert "norm(force, -3.0, 2.0)" in str(coding.spec())
    assert coding.spec() != coded(Tiles(inputs=("push", "p0"))).spec()
    assert coding.spec() == coded(Tiles(inputs=("push", "p0")), Tiles(inputs=("push", "p1"))).spec()


@pytest.mark.parametrize("inputs", [[np.nan, 0.0], [np.inf, 0.0], [0.0]])
def test_inputs_that_are_not_known_have_no_features(inputs: list[float]) -> None:
    coding = coded(Tiles(inputs=("p0", "p1")))
    with pytest.raises(ValueError, match="2 finite inputs are needed"):
        coding.encode(np.array(inputs))


@pytest.mark.parametrize(
    ("tiles", "why"),
    [
        (Tiles(inputs=("force",)), r"tiles\.0\.inputs: 'force' goes from -3 to 2, .*: write norm\(force\)"),
        (Tiles(inputs=("nobody",)), r"learn\.representations\.0\.tiles\.0\.inputs: column 1 of 'nobody'"),
        (Tiles(inputs=("*.nobody",)), r"stands for no signal"),
        (Tiles(inputs=("p0",), combine="pairs"), r"inputs: 1 input makes no pair"),
        (Tiles(inputs=("p0", "p1"), width=(0.5,)), r"tiles\.0: 2 dimensions need as many widths"),
        (Tiles(inputs=INPUTS, width=0.05), r"tiles\.0: .* give them memory"),
        (Tiles(inputs=("p*",), combine="pairs", tilings=1024, memory=16), r"28672 tilings.*at most 16384"),
    ],
)
def test_a_table_that_makes_no_representation_is_refused(tiles: Tiles, why: str) -> None:
    with pytest.raises(ConfigError, match=why):
        coded(tiles)


def test_representations_are_known_by_their_names_and_the_arms_own_comes_first() -> None:
    table = RepresentationTable(name="mine", raw=("j0.load",))
    learn = Learn(joints=("j1",), representations=(table,))
    assert list(codings(learn, SPECS, Signals(SPECS))) == ["arm", "mine"]
    with pytest.raises(ConfigError, match=r"representations\.1\.name: there is a representation 'mine'"):
        codings(Learn(joints=("j1",), representations=(table, table)), SPECS, Signals(SPECS))
