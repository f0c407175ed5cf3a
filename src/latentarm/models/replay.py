"""A computation on fixed tensors, recorded once and repeated.

The networks here are so small that a step of training in torch spends much of its time outside the
arithmetic: on Python, on the graph for the gradient, on memory. A `RecordedStep` runs the arithmetic alone:
it records the operations of torch (ATen) that a computation and its gradient consist of, below autograd,
and runs them again into memory that was laid out once. Views cost nothing in a replay, and what does not
depend on the inputs is not computed again. The kernels are the same, and so are the results.

This is to the CPU what a CUDA graph is to a GPU.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, Final, NamedTuple, cast, final

import torch
from torch import Tensor
from torch.utils._python_dispatch import TorchDispatchMode
from torch.utils._pytree import tree_leaves, tree_map

Operation = torch._ops.OpOverload  # pyright: ignore[reportPrivateUsage]
ROOMY: Final = 4  # a block of memory is used again for a tensor that is at most so many times smaller


class UnreplayableError(Exception):
    """The computation depends on values in a way that a replay cannot repeat."""


class _Call(NamedTuple):
    """One operation of torch, with its arguments and result."""

    operation: Operation
    args: tuple[Any, ...]
    kwargs: Mapping[str, Any]
    result: Any
    read: set[int]
    written: set[int]  # storages that it wrote to; empty for views
    in_place: bool  # whether it wrote to an argument

    @property
    def fills(self) -> bool:
        """Whether it leaves anything in the memory that it returns."""
        return not self.operation.overloadpacket.__name__.startswith(("empty", "new_empty"))


@final
class _Recorder(TorchDispatchMode):
    """Runs operations and records them."""

    def __init__(self) -> None:
        super().__init__()
        self.calls: list[_Call] = []

    @classmethod
    def _should_skip_dynamo(cls) -> bool:
        # As torch documents it: nothing is compiled here, and asking for it would import the compiler.
        return False

    def __torch_dispatch__(
        self,
        func: Operation,
        types: Sequence[type],
        args: tuple[Any, ...] = (),
        kwargs: Mapping[str, Any] | None = None,
    ) -> Any:
        named = kwargs or {}
        result = func(*args, **named)
        if torch.Tag.inplace_view in func.tags:
            return result  # such as squeeze_: it moves nothing, and later calls find the new shape
        if _depends_on_values(func, args):
            raise UnreplayableError(f"{func} returns what depends on values.")
        changed = [
            args[place] if place < len(args) else named.get(argument.name)
            for place, argument in enumerate(func._schema.arguments)  # pyright: ignore[reportPrivateUsage]
            if argument.alias_info is not None and argument.alias_info.is_write
        ]
        read, returned = _storages((args, named)), _storages(result)
        in_place = bool(_tensors(changed))
        written = _storages(changed) if in_place else returned - read
        if not in_place and written and written != returned:
            raise UnreplayableError(f"{func} returns views and values at once.")
        # Aliases, because a tensor's own shape may be changed in place later.
        seen, seen_named, seen_result = tree_map(_alias, (args, dict(named), result))
        self.calls.append(_Call(func, seen, seen_named, seen_result, read, written, in_place))
        return result


@final
class RecordedStep:
    """Repeats a computation that writes its results in place into tensors outside it."""

    def __init__(self, compute: Callable[[], None], inputs: Sequence[Tensor], device: torch.device) -> None:
        """Run a computation once on a device, and record it.

        ``compute`` reads and writes tensors by the same operations whatever the values of ``inputs``, which
        are all the tensors whose values change from one call to the next. Any other tensor counts as
        constant.

        Raises UnreplayableError where the operations depend on values.
        """
        with _Recorder() as recorder:
            compute()
        calls = _varying(recorder.calls, _storages(inputs))
        with torch.no_grad():
            self._steps = [_bound(*step) for step in _placed(calls, device)]

    @torch.no_grad()
    def __call__(self) -> None:
        """Repeat the computation on what the inputs hold now."""
        for step in self._steps:
            step()


def _bound(
    operation: Operation, args: tuple[Any, ...], kwargs: Mapping[str, Any], result: Any
) -> Callable[[], object]:
    """One step, which has run once, as a call without arguments. torch's namesakes cost half as much."""
    if result is not None:

        def copied() -> None:
            for place, value in zip(_tensors(result), _tensors(operation(*args, **kwargs)), strict=True):
                place.copy_(value)

        copied()
        return copied
    name = operation.overloadpacket.__name__
    function = getattr(torch, name, None) or getattr(Tensor, name, None)
    if callable(function):
        try:
            function(*args, **kwargs)
        except TypeError:
            pass
        else:
            return partial(function, *args, **kwargs)
    operation(*args, **kwargs)
    return partial(operation, *args, **kwargs)


def _depends_on_values(operation: Operation, args: tuple[Any, ...]) -> bool:
    """Whether the shape of the result, or a number in Python, depends on values."""
    if torch.Tag.data_dependent_output in operation.tags:
        return True
    indexed = operation.overloadpacket.__name__ == "index"
    if indexed and all(index.dtype == torch.int64 for index in _tensors(args[1])):
        return False
    return torch.Tag.dynamic_output_shape in operation.tags


def _alias(leaf: Any) -> Any:
    """The same memory with the shape that it has now, of a tensor."""
    return leaf.detach() if isinstance(leaf, Tensor) else leaf


def _tensors(tree: Any) -> list[Tensor]:
    return [leaf for leaf in tree_leaves(tree) if isinstance(leaf, Tensor)]


def _storages(tree: Any) -> set[int]:
    """Addresses of the memory of all tensors that have any."""
    return {_storage(tensor) for tensor in _tensors(tree) if tensor.untyped_storage().nbytes()}


def _storage(tensor: Tensor) -> int:
    return tensor.untyped_storage().data_ptr()


def _varying(calls: Sequence[_Call], inputs: set[int]) -> list[_Call]:
    """The calls that must run again when inputs change: no views, nothing constant."""
    varying, known = set(inputs), 0
    while len(varying) != known:
        known = len(varying)
        for call in calls:
            drawn = torch.Tag.nondeterministic_seeded in call.operation.tags
            if call.written and (drawn or (call.read | call.written) & varying):
                varying |= call.written
    return [call for call in calls if call.written & varying]


def _placed(
    calls: Sequence[_Call], device: torch.device
) -> list[tuple[Operation, tuple[Any, ...], Mapping[str, Any], Any]]:
    """Operation, arguments and place for its result, if any, of each call; results' memory is reused."""
    homes = dict(_homes(calls, device))

    def moved(leaf: Any) -> Any:
        if not isinstance(leaf, Tensor):
            return leaf
        home = homes.get(_storage(leaf)) if leaf.untyped_storage().nbytes() else None
        if home is None:
            return leaf.detach()
        empty = torch.empty(0, dtype=leaf.dtype, device=device)
        return empty.set_(home, leaf.storage_offset(), leaf.shape, leaf.stride())

    steps: list[tuple[Operation, tuple[Any, ...], Mapping[str, Any], Any]] = []
    for call in calls:
        args, kwargs = tree_map(moved, call.args), tree_map(moved, dict(call.kwargs))
        if call.in_place:
            steps.append((call.operation, args, kwargs, None))
        elif call.fills:
            result, into = tree_map(moved, call.result), _writes_into(call.operation)
            if into is None:
                steps.append((call.operation, args, kwargs, result))
            else:
                places = result if isinstance(result, tuple | list) else (result,)
                named = dict(zip(into[1], places, strict=True))
                steps.append((into[0], args, {**kwargs, **named}, None))
    return steps


def _homes(calls: Sequence[_Call], device: torch.device) -> Iterator[tuple[int, torch.UntypedStorage]]:
    """Memory for each storage that the calls make; two share it where one is last used before the other."""
    made = {
        _storage(tensor): tensor.untyped_storage().nbytes()
        for call in calls
        if not call.in_place
        for tensor in _tensors(call.result)
    }
    last = {storage: place for place, call in enumerate(calls) for storage in call.read | call.written}
    waiting, free = dict(made), list[torch.UntypedStorage]()
    homes: dict[int, torch.UntypedStorage] = {}
    for place, call in enumerate(calls):
        for storage in call.written & waiting.keys():
            size = waiting.pop(storage)
            fitting = [block for block in free if size <= block.nbytes() <= ROOMY * size]
            if fitting:
                home = min(fitting, key=torch.UntypedStorage.nbytes)
                free = [block for block in free if block is not home]
            else:
                home = torch.empty(size, dtype=torch.uint8, device=device).untyped_storage()
            homes[storage] = home
            yield storage, home
        for storage in call.read | call.written:
            if last[storage] == place and storage in homes:
                free.append(homes[storage])


def _writes_into(operation: Operation) -> tuple[Operation, list[str]] | None:
    """The variant of an operation that writes into tensors given to it, and their names, if it has one."""
    packet, wanted = operation.overloadpacket, _signature(operation)
    for name in packet.overloads():
        other = cast(Operation, getattr(packet, name))
        arguments = other._schema.arguments  # pyright: ignore[reportPrivateUsage]
        given = [argument.name for argument in arguments if argument.is_out]
        returns = operation._schema.returns  # pyright: ignore[reportPrivateUsage]
        if len(given) == len(returns) > 0 and _signature(other) == wanted:
            return other, given
    return None


def _signature(operation: Operation) -> list[tuple[str, str]]:
    """Names and types of the arguments that are no results."""
    arguments = operation._schema.arguments  # pyright: ignore[reportPrivateUsage]
    return [(argument.name, str(argument.type)) for argument in arguments if not argument.is_out]
