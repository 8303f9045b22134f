"""How far a prediction can be believed (thesis 6.1), each measure cheap enough for every tick.

Thesis 6.1 asks five things of a measure of confidence. None answers all of them:

| question                                            | measure                  | and in part             |
|-----------------------------------------------------|--------------------------|-------------------------|
| 1. How accurate have predictions been lately?       | `verify`, `surprise`     | `uncertainty`           |
| 2. Have the predictions of the GVF converged?       | `interval`               | `verify`: is it good?   |
| 3. How often has the current state been visited?    | `visits` (familiarity)   | `uncertainty`           |
| 4. How accurate were they when in the current state?| `uncertainty`            | `interval`: how stable  |
| 5. How long since this state was last visited?      | `visits` (since)         | `uncertainty`, by σ     |

`uncertainty` is the thesis' own, (6.2) to (6.5), and the one that says something about 1, 3, 4 and 5 at
once. It is made of TD errors, so it tells how well a prediction agrees with the next one, not whether it
comes true: a learner over poor features may be consistent and wrong. Only `verify` compares a prediction
with what then happened, one horizon later. `surprise` is relative: a learner that is always equally wrong
does not surprise. `guard` is no measure of confidence, but tells when there can be none: that a learner has
diverged.

`visits` is one for each representation; all others are arrays with one column for each GVF of a group.
"""
