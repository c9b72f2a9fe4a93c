"""What the liquid's steps were like, for the log: what bounded them, Courant numbers, pressure iterations."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Tally:
    """Counts of one run, without what it continues. iterations of the last solution, and what bounded the last step,
    for the progress line."""

    iterations: int = 0
    bounded_by: str = ""
    solutions: int = 0
    all_iterations: int = 0
    most_iterations: int = 0
    steps: int = 0
    courants: float = 0.0
    largest_courant: float = 0.0
    shortened: int = 0
    bounded: dict[str, int] = field(default_factory=dict)

    def note_solution(self, iterations: int) -> None:
        """One pressure solution, also of a step that is tried again."""
        self.iterations = iterations
        self.solutions += 1
        self.all_iterations += iterations
        self.most_iterations = max(self.most_iterations, iterations)

    def note_step(self, bounded_by: str, courant: float) -> None:
        """One step that was made: the term that bounded it, and dt times the largest sum of |u| / dx."""
        self.steps += 1
        self.bounded_by = bounded_by
        self.bounded[bounded_by] = self.bounded.get(bounded_by, 0) + 1
        self.courants += courant
        self.largest_courant = max(self.largest_courant, courant)

    def summary(self) -> dict:
        """For run.json and the final table; {} before the first step."""
        if self.steps == 0:
            return {}
        shares = sorted(((n / self.steps, name) for name, n in self.bounded.items()), reverse=True)
        return {
            "steps_bounded_by": {name: share for share, name in shares},
            "courant": {"mean": self.courants / self.steps, "most": self.largest_courant},
            "pressure": {
                "solutions": self.solutions,
                "mean": self.all_iterations / max(self.solutions, 1),
                "most": self.most_iterations,
            },
            "shortened": self.shortened,
        }
