"""Vectors of WIDTH numbers for the kernels: what one instruction of the core works on.

The compiler makes vectors of loops by itself where it can prove that nothing overlaps, as in
`recursion`. Where it cannot, because the places are known at run time only, kernels say so: `load`
gives the WIDTH numbers of a flat array from an index on, + − * / work on all of them, `store` puts
them back. Cores with narrower vectors take two or four instructions each.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, models, overload, register_model

WIDTH = 8
"""Numbers per vector: 512 bits of float64."""
_FLAGS = ("contract", "nsz", "arcp")
_LLVM = ir.VectorType(ir.DoubleType(), WIDTH)
_MASK = ir.VectorType(ir.IntType(32), WIDTH)


class Vector(types.Type):
    """Numba's type of WIDTH float64."""

    def __init__(self) -> None:
        super().__init__(name=f"float64x{WIDTH}")


vector = Vector()


@register_model(Vector)
class _Model(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _LLVM)


def _place(context: Any, builder: Any, kind: Any, array: Any, at: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [at]), _LLVM.as_pointer())


@intrinsic
def load(typing: Any, array: Any, at: Any) -> Any:
    """Return array[at : at + WIDTH] of a flat array."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        place = _place(context, builder, signature.args[0], *given)
        return builder.load(place, align=8)

    return vector(array, types.intp), generate


@intrinsic
def store(typing: Any, array: Any, at: Any, value: Any) -> Any:
    """Write a vector to array[at : at + WIDTH] of a flat array."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        place = _place(context, builder, signature.args[0], given[0], given[1])
        builder.store(given[2], place, align=8)
        return context.get_dummy_value()

    return types.none(array, types.intp, vector), generate


@intrinsic
def fill(typing: Any, number: Any) -> Any:
    """Return a vector of equal numbers."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        nothing = ir.Constant(_LLVM, ir.Undefined)
        first = builder.insert_element(nothing, given[0], ir.Constant(ir.IntType(32), 0))
        return builder.shuffle_vector(first, nothing, ir.Constant(_MASK, [0] * WIDTH))

    return vector(types.float64), generate


def _define(operation: Callable[[Any, Any], Any], instruction: str) -> None:
    """Make an operator of two vectors an instruction."""

    @intrinsic
    def apply(typing: Any, a: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
            return getattr(builder, instruction)(*given, flags=_FLAGS)

        return vector(vector, vector), generate

    @overload(operation)
    def of_vectors(a: Any, b: Any) -> Any:
        def applied(a: Any, b: Any) -> Any:
            return apply(a, b)

        return applied if isinstance(a, Vector) and isinstance(b, Vector) else None


_define(operator.add, "fadd")
_define(operator.sub, "fsub")
_define(operator.mul, "fmul")
_define(operator.truediv, "fdiv")


def _call(builder: Any, name: str, given: Any) -> Any:
    kind = ir.FunctionType(_LLVM, [_LLVM])
    return builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{WIDTH}f64"), given
    )


@intrinsic
def roots(typing: Any, a: Any) -> Any:
    """Return the square roots of a vector."""
    return vector(vector), lambda context, builder, signature, given: _call(builder, "sqrt", given)


@intrinsic
def sizes(typing: Any, a: Any) -> Any:
    """Return the absolute values of a vector."""
    return vector(vector), lambda context, builder, signature, given: _call(builder, "fabs", given)


@intrinsic
def where_greater(typing: Any, a: Any, b: Any, x: Any, y: Any) -> Any:
    """Return x where a > b, elsewhere y."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", given[0], given[1]), given[2], given[3])

    return vector(vector, vector, vector, vector), generate
