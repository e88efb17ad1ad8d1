"""Sinew from Python: recordings, model files, and what check-data and close-loop find.

    import sinew

    run = sinew.Recording("run.mcap")                  # topics as NumPy arrays, messages as dicts
    model = sinew.load_model("model.yaml")             # joints, constants with units, terms
    check = sinew.check_data(["a.csv", "b.csv"], model=model)
    report = sinew.close_loop(model, ["a.csv", "b.csv"], "c.csv", out="found")
    report.verdict, report.effects, report.errors, report.model

Every object prints itself in a terminal. Needs NumPy and PyYAML; check_data, close_loop and run call the program
`sinew`, from PATH or given as sinew=PATH; reading needs none. docs/interchange.md has more.
"""
from sinew_recording import Message, Recording, RecordingError

from .command import SinewError, check_data, close_loop, run
from .model import Joint, Model, ModelError, Parameter, Term, load_model
from .report import Check, Effect, Fault, Finding, Picture, Report, RobotReport, read_check, read_report

__all__ = [
    "Check", "Effect", "Fault", "Finding", "Joint", "Message", "Model", "ModelError", "Parameter", "Picture",
    "Recording", "RecordingError", "Report", "RobotReport", "SinewError", "Term", "check_data", "close_loop",
    "load_model", "read_check", "read_report", "run"]
