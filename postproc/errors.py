"""What is told to the user instead of a traceback."""

from __future__ import annotations


class PostprocError(Exception):
    """One line for the user. exit_code 1: something failed; 2: the command line is wrong."""

    exit_code = 1


class WrongRequest(PostprocError):
    """The command asks for something that is not there."""

    exit_code = 2
