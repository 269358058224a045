/* The charts of a machine that reports an interval: the truth against the margins, and the interval on the line. */

const NM_PER_MM = 1e6;

function ofInterval(data, trace) {
  const names = data.reported;
  if (!names || !trace.names.outputs.includes(names.position)) return [];
  const output = (name) => trace.series("outputs", name).map((value) => (value === null ? null : Number(value)));
  const valid = trace.series("outputs", names.valid).map((value) => value === names.valid_is);
  const reportedOnly = (values) => values.map((value, step) => (valid[step] ? value : null));
  const position = reportedOnly(output(names.position));
  const low = minus(position, output(names.below));
  const high = plus(position, output(names.above));
  const truth = truthOf(trace, names.truth);
  const away = (values) => minus(values, position);
  const limit = data.tolerance_mm;
  const tolerance = limit === null ? [] : [
    { name: "+ tolerance", values: position.map((value) => (value === null ? null : limit)) },
    { name: "\u2212 tolerance", values: position.map((value) => (value === null ? null : -limit)) },
  ];
  return [
    {
      title: `truth and margins from ${names.position}`,
      unit: "mm",
      lines: [{ name: "truth", values: away(truth) }, { name: "+ margin", values: away(high) }, { name: "\u2212 margin", values: away(low) }, ...tolerance],
      band: [away(low), away(high)],
    },
    {
      title: `${names.position} on the line`,
      unit: "mm",
      lines: [{ name: "truth", values: truth }, { name: "reported position", values: position }],
      band: [low, high],
    },
  ].filter(({ lines }) => lines.some(({ values }) => values.some((value) => value !== null)));
}

/* The ghost in mm; of a recorded run, which has no ghost, the recorded truth. */
function truthOf(trace, ghost) {
  const values = ghost && trace.names.state.includes(ghost) ? trace.series("state", ghost) : null;
  if (values?.some((value) => value !== null)) return values.map((value) => (value === null ? null : Number(value) / NM_PER_MM));
  return trace.truth.map((value) => (value === null ? null : Number(value)));
}

const minus = (one, other) => one.map((value, step) => (value === null || other[step] === null ? null : value - other[step]));
const plus = (one, other) => one.map((value, step) => (value === null || other[step] === null ? null : value + other[step]));
