"""Who knows what of old, when questions are put together anew."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bentod.learn.kernel import Kernel, choose
from bentod.learn.lazy import Real
from bentod.learn.lazy_compiled import missing
from bentod.learn.lazy_numpy import NumpyKernel
from bentod.learn.paths import below
from bentod.learn.predictor import Predictor
from bentod.learn.succession import Heritage, succeed
from bentod.learn.unit import Unit
from tests.learn.journeys import follow, new_group, random_journeys
from tests.learn.predictors import gvf, live, new_predictor


def of_20(*names: str, **learn: object) -> tuple[Predictor, Unit]:
    """A predictor with further questions about 20 ticks, and the unit that answers them; both have lived."""
    predictor = new_predictor(timescales=(20.0,), gvfs=[gvf(name=name) for name in names], **learn)
    live(predictor, 0, 30)
    return predictor, predictor.horde.units[0]


KERNELS = [NumpyKernel(), *([] if missing() else [choose("compiled")])]
ARM = ("shoulder.position@20", "elbow.position@20")


def weights(unit: Unit) -> NDArray[np.float64]:
    return unit.pupils.weights()


def test_columns_that_both_know_are_handed_on_and_the_others_begin_anew() -> None:
    _, old = of_20("a", "b")
    _, new = of_20("c", "b")
    heritage = Heritage([((*ARM, "a", "b"), old.memory())])
    assert heritage.hand_on(new, (*ARM, "c", "b"), frozenset((*ARM, "b"))) == ["c"]
    np.testing.assert_array_equal(weights(new)[:, [0, 1, 3]], weights(old)[:, [0, 1, 3]])
    assert not weights(new)[:, 2].any()


def test_a_question_that_means_something_else_now_is_not_handed_on() -> None:
    _, old = of_20("a")
    _, new = of_20("a")
    heritage = Heritage([((*ARM, "a"), old.memory())])
    assert heritage.hand_on(new, (*ARM, "a"), frozenset(ARM)) == ["a"]
    assert not weights(new)[:, 2].any()
    assert weights(new)[:, 1].any()


def test_the_unit_that_knows_most_hands_on() -> None:
    _, old = of_20("a")
    _, new = of_20("a")
    _, stranger = of_20("x", step_size=0.1)
    heritage = Heritage([(("a", "x", "y"), stranger.memory()), ((*ARM, "a"), old.memory())])
    assert heritage.hand_on(new, (*ARM, "a"), frozenset((*ARM, "a"))) == []
    np.testing.assert_array_equal(weights(new), weights(old))


def test_who_has_no_ancestors_begins_anew() -> None:
    _, unit = of_20("a")
    before = weights(unit)
    assert Heritage([]).hand_on(unit, (*ARM, "a"), frozenset(ARM)) == [*ARM, "a"]
    assert Heritage([(("z",), {})]).hand_on(unit, (*ARM, "a"), frozenset(ARM)) == [*ARM, "a"]
    succeed(unit, (*ARM, "a"), [], frozenset(ARM))
    np.testing.assert_array_equal(weights(unit), before)


@pytest.mark.parametrize(
    ("key", "why"),
    [
        ("pupils/weights", "lacks pupils/weights"),
        ("doubts/error/square", "lacks doubts/error/square"),
    ],
)
def test_a_memory_that_lacks_something_is_refused(key: str, why: str) -> None:
    _, old = of_20("a")
    _, new = of_20("a")
    memory = {name: array for name, array in old.memory().items() if name != key}
    with pytest.raises(ValueError, match=why):
        Heritage([((*ARM, "a"), memory)]).hand_on(new, (*ARM, "a"), frozenset(ARM))


def test_a_memory_of_another_shape_is_refused() -> None:
    _, old = of_20("a")
    _, new = of_20("a")
    memory = old.memory()
    memory["pupils/weights"] = memory["pupils/weights"][:-1]
    with pytest.raises(ValueError, match=r"pupils/weights has the shape \(64, 3\), but should have \(65,\)"):
        Heritage([((*ARM, "a"), memory)]).hand_on(new, (*ARM, "a"), frozenset(ARM))


def test_the_joint_memory_of_units_is_told_apart_by_their_places() -> None:
    predictor = new_predictor()
    live(predictor, 0, 10)
    names = [["shoulder.position@5", "elbow.position@5"], list(ARM)]
    heritage = Heritage.of(names, below(predictor.memory(), "units"))
    for (asked, memory), unit, expected in zip(heritage.units, predictor.horde.units, names, strict=True):
        assert asked == expected
        assert memory.keys() == unit.memory().keys()
        np.testing.assert_array_equal(memory["pupils/weights"], weights(unit))


def test_a_unit_that_succeeds_another_is_where_that_was_to_the_last_bit() -> None:
    old_predictor, old = of_20("a", "b")
    new = new_predictor(timescales=(20.0,), gvfs=[gvf(name=name) for name in "cb"]).horde.units[0]
    expected = old.memory()
    succeed(new, (*ARM, "c", "b"), [((*ARM, "a", "b"), old)], frozenset((*ARM, "b")))
    for key, array in new.memory().items():
        mine, theirs = (array, expected[key])
        if key in new.own():
            mine, theirs = mine[..., [0, 1, 3]], theirs[..., [0, 1, 3]]
        np.testing.assert_array_equal(mine, theirs, err_msg=key)
    assert not weights(new)[:, 2].any()
    assert old_predictor.horde.units[0] is old


@pytest.mark.parametrize("kernel", KERNELS, ids=lambda kernel: kernel.name.split()[0])
@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_group_goes_on_where_another_was_in_the_middle_of_an_epoch(
    kernel: Kernel, dtype: type[Real]
) -> None:
    for seed in range(12):
        lived = random_journeys(seed, gvfs=3)
        lived.gammas[:], lived.lams[:] = 0.9, 0.8
        undisturbed, old, new = (new_group(lived, "true_online", kernel, dtype) for _ in range(3))
        follow(undisturbed, lived, end=30 + seed)
        follow(old, lived, end=30 + seed)
        follow(new, lived, end=seed)  # whatever it was doing before
        new.go_on(old, [2, 1, 0], [2, 1, 0])
        mine, theirs = follow(new, lived, first=30 + seed), follow(undisturbed, lived, first=30 + seed)
        np.testing.assert_array_equal(mine.predictions, theirs.predictions)
        np.testing.assert_array_equal(mine.weights, theirs.weights)
        np.testing.assert_array_equal(new.memory()["reach"], undisturbed.memory()["reach"])


def test_a_group_goes_on_only_where_one_like_it_was() -> None:
    _, old = of_20("a")
    for learn in ({"step_size": 0.1}, {"precision": "float32"}, {"memory": 128}):
        _, new = of_20("a", **learn)
        with pytest.raises(ValueError, match="learns likewise"):
            new.pupils.go_on(old.pupils, [0], [0])
    alone = new_predictor(gvfs=[gvf(algorithm="tidbd")]).horde.units
    (tidbd,) = (unit for unit in alone if len(unit.places) == 1)
    with pytest.raises(ValueError, match="stood alone"):
        old.pupils.go_on(tidbd.pupils, [0], [0])
    with pytest.raises(ValueError, match="stand alone"):
        tidbd.pupils.go_on(old.pupils, [0], [0])
