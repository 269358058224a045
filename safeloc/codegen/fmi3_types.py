"""The C interface of FMI 3.0: the types that a co-simulation unit needs, and stubs of the functions that it lacks.

Names and signatures are those of the standard; an importer looks every function up by name.
"""

from __future__ import annotations

DECLARATIONS = """#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum { fmi3Independent, fmi3Constant, fmi3Fixed, fmi3Tunable, fmi3Discrete, fmi3Dependent } fmi3DependencyKind;
typedef enum { fmi3IntervalNotYetKnown, fmi3IntervalUnchanged, fmi3IntervalChanged } fmi3IntervalQualifier;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, double, bool, bool, bool, bool, bool *, double *);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);
"""

_NUMBERS = {
    "Float32": "float",
    "Int8": "int8_t",
    "UInt8": "uint8_t",
    "Int16": "int16_t",
    "UInt16": "uint16_t",
    "Int32": "int32_t",
    "UInt32": "uint32_t",
    "UInt64": "uint64_t",
    "String": "fmi3String",
}
_REFERENCES = "fmi3Instance instance, const fmi3ValueReference references[], size_t count"
_FROM = "fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging"
_HOST = "fmi3InstanceEnvironment environment, fmi3LogMessageCallback log"
_PRODUCTS = "const fmi3ValueReference knowns[], size_t known_count, const double seed[], size_t seed_count"

_NOT_HERE = [
    *(f"Get{kind}({_REFERENCES}, {c} values[], size_t size)" for kind, c in _NUMBERS.items()),
    *(f"Set{kind}({_REFERENCES}, const {c} values[], size_t size)" for kind, c in _NUMBERS.items()),
    f"SetFloat64({_REFERENCES}, const double values[], size_t size)",
    f"GetBinary({_REFERENCES}, size_t sizes[], fmi3Binary values[], size_t size)",
    f"SetBinary({_REFERENCES}, const size_t sizes[], const fmi3Binary values[], size_t size)",
    f"GetClock({_REFERENCES}, bool values[])",
    f"SetClock({_REFERENCES}, const bool values[])",
    "GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference reference, size_t *count)",
    "GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent, size_t elements[], "
    "fmi3ValueReference independents[], size_t places[], fmi3DependencyKind kinds[], size_t count)",
    f"GetDirectionalDerivative({_REFERENCES}, {_PRODUCTS}, double sensitivity[], size_t size)",
    f"GetAdjointDerivative({_REFERENCES}, {_PRODUCTS}, double sensitivity[], size_t size)",
    "EnterConfigurationMode(fmi3Instance instance)",
    "ExitConfigurationMode(fmi3Instance instance)",
    f"GetIntervalDecimal({_REFERENCES}, double intervals[], fmi3IntervalQualifier qualifiers[])",
    f"GetIntervalFraction({_REFERENCES}, uint64_t counters[], uint64_t resolutions[], fmi3IntervalQualifier qualifiers[])",
    f"GetShiftDecimal({_REFERENCES}, double shifts[])",
    f"GetShiftFraction({_REFERENCES}, uint64_t counters[], uint64_t resolutions[])",
    f"SetIntervalDecimal({_REFERENCES}, const double intervals[])",
    f"SetIntervalFraction({_REFERENCES}, const uint64_t counters[], const uint64_t resolutions[])",
    f"SetShiftDecimal({_REFERENCES}, const double shifts[])",
    f"SetShiftFraction({_REFERENCES}, const uint64_t counters[], const uint64_t resolutions[])",
    "EvaluateDiscreteStates(fmi3Instance instance)",
    "UpdateDiscreteStates(fmi3Instance instance, bool *again, bool *terminate, bool *nominals, bool *values, "
    "bool *defined, double *time)",
    "EnterEventMode(fmi3Instance instance)",
    "EnterContinuousTimeMode(fmi3Instance instance)",
    "CompletedIntegratorStep(fmi3Instance instance, bool final, bool *event, bool *terminate)",
    "SetTime(fmi3Instance instance, double time)",
    "SetContinuousStates(fmi3Instance instance, const double states[], size_t count)",
    "GetContinuousStateDerivatives(fmi3Instance instance, double derivatives[], size_t count)",
    "GetEventIndicators(fmi3Instance instance, double indicators[], size_t count)",
    "GetContinuousStates(fmi3Instance instance, double states[], size_t count)",
    "GetNominalsOfContinuousStates(fmi3Instance instance, double nominals[], size_t count)",
    "GetNumberOfEventIndicators(fmi3Instance instance, size_t *count)",
    "GetNumberOfContinuousStates(fmi3Instance instance, size_t *count)",
    "EnterStepMode(fmi3Instance instance)",
    f"GetOutputDerivatives({_REFERENCES}, const int32_t orders[], double values[], size_t size)",
    "ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock, double time)",
]
_OTHER_KINDS = [
    f"InstantiateModelExchange({_FROM}, {_HOST})",
    f"InstantiateScheduledExecution({_FROM}, {_HOST}, fmi3ClockUpdateCallback clock, fmi3LockPreemptionCallback lock, "
    "fmi3UnlockPreemptionCallback unlock)",
]


def not_here() -> str:
    """Return stubs that refuse the features that the unit lacks: other kinds of variables, interfaces, derivatives, clocks."""
    refusing = [_refusing("fmi3Status", one, "refused(instance)") for one in _NOT_HERE]
    return "\n".join([*refusing, *(_refusing("fmi3Instance", one, "NULL") for one in _OTHER_KINDS)])


def _refusing(kind: str, signature: str, result: str) -> str:
    arguments = signature[signature.index("(") + 1 : -1].split(", ")
    names = [name for one in arguments if (name := one.removesuffix("[]").split()[-1].lstrip("*")) not in result]
    unused = "".join(f"    (void){name};\n" for name in names)
    return f"EXPORTED {kind} fmi3{signature}\n{{\n{unused}    return {result};\n}}\n"
