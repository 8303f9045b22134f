"""Every study by its name: a new one is a module with a `STUDY`, and a line here."""

from collections.abc import Mapping

from sim.studies import boosting, cliffs
from sim.studies.study import Study

STUDIES: Mapping[str, Study] = {
    "cliffs": cliffs.STUDY,
    "boosting": boosting.STUDY,
}
