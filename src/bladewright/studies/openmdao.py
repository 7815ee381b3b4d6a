"""Designs as a component of OpenMDAO: variables as inputs, figures as outputs, with exact partials."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

from bladewright.designs import Design
from bladewright.errors import StudyError
from bladewright.studies.problem import Problem
from bladewright.studies.quantities import quantities_of
from bladewright.studies.sweep import Given, range_of
from bladewright.studies.variables import resolved


def openmdao_component(
    design: Design | Mapping[str, Design],
    variables: Mapping[str, Given],
    quantities: Sequence[str | Callable[..., Any]],
) -> Any:
    """An OpenMDAO ExplicitComponent: variables as inputs, figures as outputs, exact partials at the design's own knots.

    Arguments are those of `sweep`. Inputs and outputs are in their own units, under their names with `_` for what
    OpenMDAO does not allow: `stagger[1]` is `stagger_1`. Raises StudyError where OpenMDAO is missing.
    """
    try:
        import openmdao.api as om
    except ImportError as error:
        raise StudyError(f"OpenMDAO is not installed ({error}): pip install 'bladewright[openmdao]'") from error
    designs: dict[str, Any] = dict(design) if isinstance(design, Mapping) else {str(cast("Any", design).name): design}
    ranges = resolved({name: range_of(name, given) for name, given in variables.items()}, designs)
    problem = Problem(designs, ranges, [each for asked in quantities for each in quantities_of(asked, designs)])
    problem = problem.renewed(problem.start)
    inputs = {_name(variable.name): variable for variable in problem.variables}
    outputs = {_name(figure): figure for figure in problem.figures(problem.start)}

    class BladewrightComponent(om.ExplicitComponent):  # type: ignore[misc]
        def setup(self) -> None:
            for name, variable in inputs.items():
                self.add_input(name, val=variable.start)
            for name in outputs:
                self.add_output(name)
            self.declare_partials("*", "*")

        def compute(self, values: Any, found: Any) -> None:
            figures = problem.figures(self._x(values))
            for name, figure in outputs.items():
                found[name] = figures[figure]

        def compute_partials(self, values: Any, partials: Any) -> None:
            gradients = problem.gradients(self._x(values))
            for name, figure in outputs.items():
                for place, (entry, width) in enumerate(zip(inputs, problem.width, strict=True)):
                    partials[name, entry] = gradients[figure][place] / width

        def _x(self, values: Any) -> Any:
            return problem.vector({variable.name: values[name].item() for name, variable in inputs.items()})

    return BladewrightComponent()


def _name(name: str) -> str:
    return "_".join("".join(sign if sign.isalnum() else " " for sign in name).split())
