"""WIDTH doubles as one value in a numba kernel: one number for each of the lanes.

Where a loop over lanes is left to the compiler, sums over sites go through memory, as it cannot
prove that they may stay in a register; and where places are known at run time only it makes no
vectors at all, as they might overlap. Here vectors are values like any other. Each operation is one
AVX-512 instruction, or two of AVX2; products and sums are contracted to multiply-adds.
"""

from __future__ import annotations

import operator
from typing import Any, ClassVar, TypeAlias

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

WIDTH = 8
"""Lanes of a vector."""


Vector: TypeAlias = Any
"""What numba knows as `VectorType`; outside kernels there is none."""


class VectorType(types.Type):
    """The numba type of WIDTH doubles."""

    def __init__(self) -> None:
        super().__init__(name="Vector")


vector = VectorType()
_llvm = ir.VectorType(ir.DoubleType(), WIDTH)


@register_model(VectorType)
class _Model(models.PrimitiveModel):  # type: ignore[misc]
    def __init__(self, manager: Any, of: VectorType) -> None:
        super().__init__(manager, of, _llvm)


def _place(context: Any, builder: Any, kind: Any, array: Any, first: Any) -> Any:
    data = context.make_array(kind)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [first]), _llvm.as_pointer())


@intrinsic
def write(typing: Any, array: Any, first: Any, value: Any) -> Any:
    """Write a vector to array[first] and what follows, wherever in the cache that is."""

    def generate(context: Any, builder: Any, of: Any, values: Any) -> Any:
        builder.store(values[2], _place(context, builder, of.args[0], *values[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, vector), generate


@intrinsic
def read(typing: Any, array: Any, first: Any) -> Any:
    """Return the vector that starts at array[first], wherever in the cache that is."""

    def generate(context: Any, builder: Any, of: Any, values: Any) -> Any:
        return builder.load(_place(context, builder, of.args[0], *values), align=8)

    return vector(array, types.intp), generate


def _apply(builder: Any, name: str, values: Any) -> Any:
    kind = ir.FunctionType(_llvm, [_llvm])
    full = f"llvm.{name}.v{WIDTH}f64"
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, full), values)


@intrinsic
def roots(typing: Any, a: Any) -> Any:
    """Return the square roots."""
    return vector(vector), lambda context, builder, of, values: _apply(builder, "sqrt", values)


@intrinsic
def sizes(typing: Any, a: Any) -> Any:
    """Return the absolute values."""
    return vector(vector), lambda context, builder, of, values: _apply(builder, "fabs", values)


@intrinsic
def where_greater(typing: Any, a: Any, b: Any, x: Any, y: Any) -> Any:
    """Return x where a > b, elsewhere y."""

    def generate(context: Any, builder: Any, of: Any, values: Any) -> Any:
        return builder.select(builder.fcmp_ordered(">", *values[:2]), *values[2:])

    return vector(vector, vector, vector, vector), generate


def _same(builder: Any, value: Any) -> Any:
    if value.type == _llvm:
        return value
    first = builder.insert_element(_llvm(ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    everywhere = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(first, _llvm(ir.Undefined), everywhere)


@intrinsic
def everywhere(typing: Any, value: Any) -> Any:
    """Return the vector with a number in each lane."""

    def generate(context: Any, builder: Any, of: Any, values: Any) -> Any:
        return _same(builder, values[0])

    return vector(types.float64), generate


def _define(operation: Any, name: str) -> None:
    """Let numba know an operation between vectors, or a vector and a number."""
    operands = [(vector, vector), (vector, types.float64), (types.float64, vector)]

    class Template(ConcreteTemplate):  # type: ignore[misc]
        cases: ClassVar = [signature(vector, *of) for of in operands]

    infer_global(operation)(Template)

    def generate(context: Any, builder: Any, of: Any, values: Any) -> Any:
        a, b = (_same(builder, value) for value in values)
        return getattr(builder, name)(a, b, flags=("contract", "nsz"))

    for of in operands:
        lower_builtin(operation, *of)(generate)


for _operation, _name in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _define(_operation, _name)


@infer_global(operator.neg)
class _Negation(ConcreteTemplate):  # type: ignore[misc]
    cases: ClassVar = [signature(vector, vector)]


@lower_builtin(operator.neg, vector)
def _negate(context: Any, builder: Any, of: Any, values: Any) -> Any:
    return builder.fneg(values[0])
