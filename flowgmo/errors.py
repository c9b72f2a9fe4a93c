"""Errors that reach the user as one readable text, never as a traceback."""

from __future__ import annotations


class FlowgmoError(Exception):
    """Base of all errors that carry a text for the user."""


class StepFailed(FlowgmoError):
    """A step that cannot be computed. The State stays as it was before the step."""


class StepTooLong(StepFailed):
    """A step that failed, where a shorter one may do; share: of its length that should be tried, None where unknown;
    advice: what to write where no shorter one does."""

    def __init__(self, text: str, share: float | None = None, advice: str = "") -> None:
        super().__init__(text)
        self.share, self.advice = share, advice
