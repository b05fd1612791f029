"""GR(1) specifications: syntax, readers and writers. Nothing is solved here."""

from surefoot.logic.evaluate import Evaluator
from surefoot.logic.lower import Lowering, range_conjuncts
from surefoot.logic.readers import parse_slugsin, parse_structuredslugs, read_specification
from surefoot.logic.syntax import Conjunct, Expression, Specification, Variable
from surefoot.logic.transducer import Transducer
from surefoot.logic.writers import infix, write_slugsin, write_structuredslugs

__all__ = [
    "Conjunct",
    "Evaluator",
    "Expression",
    "Lowering",
    "Specification",
    "Transducer",
    "Variable",
    "infix",
    "parse_slugsin",
    "parse_structuredslugs",
    "range_conjuncts",
    "read_specification",
    "write_slugsin",
    "write_structuredslugs",
]
