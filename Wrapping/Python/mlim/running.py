"""Running a filter from Python: progress, Ctrl-C, errors as exceptions, warnings as warnings."""

from __future__ import annotations

import contextlib
import shutil
import signal
import sys
import threading
import time
import warnings
from typing import Callable, Iterator

Progress = Callable[[float, str], object]

# Seconds between two redraws of the progress line.
_REDRAW_INTERVAL = 0.1
_BAR_WIDTH = 24


class MeshError(RuntimeError):
    """The image or an option cannot be used, or meshing failed; the text says why."""


class MeshWarning(UserWarning):
    """What a filter passed over or could not reach; the text says what."""


def update(algorithm, progress: bool | Progress | None = None) -> None:
    """Brings a filter up to date, as its Update() does.

    progress: True or False: a line on sys.stderr or none; None: a line if that is a terminal; a
        function: called with the fraction done and the stage's name, and stops the run by
        returning False.

    Raises MeshError with the filter's sentence, also if `progress` stopped the run. What `progress`
    raises comes out here, and Ctrl-C as KeyboardInterrupt, within a tenth of a second; the filter's
    output is empty then. Warnings are of the category MeshWarning.
    """
    errors: list[str] = []
    texts: list[str] = []
    if progress is None:
        progress = sys.stderr is not None and sys.stderr.isatty()
    line = _ProgressLine() if progress is True else None
    show = line.show if line else progress or None
    raised: list[BaseException] = []
    is_interrupted = threading.Event()

    def look(caller, _event) -> None:
        if is_interrupted.is_set():
            caller.SetAbortExecute(True)
            return
        try:
            if show and show(caller.GetProgress(), caller.GetProgressText() or "") is False:
                caller.SetAbortExecute(True)
        except BaseException as error:  # VTK would print it and go on
            raised.append(error)
            caller.SetAbortExecute(True)

    # A filter that was stopped once would else stop at once.
    algorithm.SetAbortExecute(False)
    with contextlib.ExitStack() as stack:
        collect_messages(algorithm, "ErrorEvent", errors, stack)
        collect_messages(algorithm, "WarningEvent", texts, stack)
        _observe(algorithm, "ProgressEvent", look, stack)
        stack.enter_context(_interrupts_to(is_interrupted))
        algorithm.Update()
    if line:
        line.clear()
    is_stopped = bool(algorithm.GetAbortExecute())
    algorithm.SetAbortExecute(False)
    for text in texts:
        warnings.warn(text, MeshWarning, stacklevel=3)
    if raised:
        raise raised[0]
    if is_interrupted.is_set():
        raise KeyboardInterrupt
    if errors:
        raise MeshError(errors[0])
    if is_stopped:
        raise MeshError("Stopped by the progress function.")


def collect_messages(
    algorithm, event: str, messages: list[str], stack: contextlib.ExitStack | None = None
) -> None:
    """Appends the text of error or warning events to a list, and keeps VTK from printing them; for
    good or until the stack is closed."""

    def keep(_caller, _event, text: str) -> None:
        # VTK's text is "ERROR: In FILE, line N\nvtkClass (0x...): sentence\n\n".
        sentence = text.strip().split("\n", 1)[-1]
        messages.append(sentence.split("): ", 1)[-1].strip())

    keep.CallDataType = "string0"
    for caller in (algorithm, algorithm.GetExecutive()):
        _observe(caller, event, keep, stack)


def _observe(caller, event: str, function, stack: contextlib.ExitStack | None) -> None:
    tag = caller.AddObserver(event, function)
    if stack is not None:
        stack.callback(caller.RemoveObserver, tag)


@contextlib.contextmanager
def _interrupts_to(is_interrupted: threading.Event) -> Iterator[None]:
    """Within, Ctrl-C sets the event. An exception in the midst of a filter would end the program:
    VTK calls Python, not the other way round. Other threads get no signals, so nothing is done."""
    is_main = threading.current_thread() is threading.main_thread()
    before = signal.getsignal(signal.SIGINT) if is_main else None
    if before is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, lambda _number, _frame: is_interrupted.set())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class _ProgressLine:
    """A line on sys.stderr that is written over and over."""

    def __init__(self) -> None:
        self.start = self.last = time.monotonic()
        self.stage = ""

    def show(self, fraction: float, stage: str) -> None:
        now = time.monotonic()
        if stage == self.stage and now - self.last < _REDRAW_INTERVAL:
            return
        self.last, self.stage = now, stage
        done = round(_BAR_WIDTH * fraction)
        bar = "#" * done + "-" * (_BAR_WIDTH - done)
        seconds = now - self.start
        clock = f"{int(seconds // 60)}:{int(seconds % 60):02d}"
        self._write(f"[{bar}] {fraction:4.0%}  {clock}  {stage}")

    def clear(self) -> None:
        self._write("")

    def _write(self, text: str) -> None:
        width = shutil.get_terminal_size().columns - 1
        # Back to the line's begin, and the rest of the line emptied.
        print(f"\r{text[:width]}\x1b[K", end="", file=sys.stderr, flush=True)
