"""Every study by its name: a new one is a module with a `STUDY`, and a line here."""

from collections.abc import Mapping

from sim.studies import boosting, cliffs, study_maze, study_patterns, study_waypoints
from sim.studies.study import Study

STUDIES: Mapping[str, Study] = {
    "cliffs": cliffs.STUDY,
    "boosting": boosting.STUDY,
    "waypoints": study_waypoints.STUDY,
    "maze": study_maze.STUDY,
    "patterns": study_patterns.STUDY,
}
