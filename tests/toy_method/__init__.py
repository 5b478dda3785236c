"""A method in a folder of its own: what the package needs of a further one, in the fewest files (test_methods.py).

It draws a ramp: every pixel's level by a formula, one stage, no geometry.
"""

from ibr_ref.methods import Method, Room

RECORD = Method(
    name="ramp",
    title="A ramp",
    source="Nobody 2000",
    package=Room("tests.toy_method.ramp"),
    contract=Room("tests.toy_method.ramp:STAGES"),
    page="tests.toy_method:method.md",
    cases=Room("tests.toy_method.case:CASES"),
    schema=Room("tests.toy_method.case:SCHEMA"),
    referee=Room("tests.toy_method.referee:RampReferee"),
    reads=Room("tests.toy_method.referee:READS"),
    judged=("kind", ("linear",)),
    plain_port=Room("tests.toy_method.port"),
    demo=Room("tests.toy_method.demo"),
)
