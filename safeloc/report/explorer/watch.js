/* Watch expressions: names, whole numbers, labels in quotes, + - *, comparisons, and, or, not, parentheses. Exact, like the machine. */

const TOKEN = /\s*(?:(\d+)|"([^"]*)"|([A-Za-z_][\w. ]*?[\w]|[A-Za-z_])(?=\s*[-+*()<>=!]|\s+(?:and|or)\b|\s*$)|(<=|>=|!=|[-+*()<>=]))/y;
const ORDER = [["or"], ["and"], ["=", "!=", "<", "<=", ">", ">="], ["+", "-"], ["*"]];

/* Returns the value of an expression; `value` gives that of a name. Error with the reason for one that has none. */
function evaluated(text, value) {
  const tokens = tokensOf(text);
  let at = 0;

  function level(depth) {
    if (depth === ORDER.length) return single();
    let left = level(depth + 1);
    while (at < tokens.length && tokens[at].sign !== undefined && ORDER[depth].includes(tokens[at].sign)) {
      const { sign } = tokens[at];
      at += 1;
      left = joined(sign, left, level(depth + 1));
    }
    return left;
  }

  function single() {
    const token = tokens[at];
    at += 1;
    if (token === undefined) throw new Error("something is missing at the end");
    if (token.sign === "-") return -whole(single());
    if (token.sign === "not") return !truth(single());
    if (token.sign === "(") {
      const inside = level(0);
      if (tokens[at]?.sign !== ")") throw new Error("a parenthesis is not closed");
      at += 1;
      return inside;
    }
    if (token.sign !== undefined) throw new Error(`${token.sign} has nothing before it`);
    return token.name === undefined ? token.value : value(token.name);
  }

  const found = level(0);
  if (at < tokens.length) throw new Error(`${tokens[at].sign ?? tokens[at].name ?? tokens[at].value} is too much`);
  return found;
}

function tokensOf(text) {
  const found = [];
  TOKEN.lastIndex = 0;
  while (text.slice(TOKEN.lastIndex).trim()) {
    const from = TOKEN.lastIndex;
    const word = /\s*(and|or|not)\b/y;
    word.lastIndex = from;
    const keyword = word.exec(text);
    if (keyword) {
      found.push({ sign: keyword[1] });
      TOKEN.lastIndex = word.lastIndex;
      continue;
    }
    TOKEN.lastIndex = from;
    const token = TOKEN.exec(text);
    if (!token) throw new Error(`not understood from ${text.slice(from).trim()}`);
    if (token[1] !== undefined) found.push({ value: BigInt(token[1]) });
    else if (token[2] !== undefined) found.push({ value: token[2] });
    else if (token[3] !== undefined) found.push(token[3] === "true" || token[3] === "false" ? { value: token[3] === "true" } : { name: token[3] });
    else found.push({ sign: token[4] });
  }
  return found;
}

function joined(sign, left, right) {
  switch (sign) {
    case "or":
      return truth(left) || truth(right);
    case "and":
      return truth(left) && truth(right);
    case "=":
      return left === right;
    case "!=":
      return left !== right;
    case "+":
      return whole(left) + whole(right);
    case "-":
      return whole(left) - whole(right);
    case "*":
      return whole(left) * whole(right);
    default:
      return compared(sign, whole(left), whole(right));
  }
}

const compared = (sign, left, right) => (sign === "<" ? left < right : sign === "<=" ? left <= right : sign === ">" ? left > right : left >= right);

function whole(value) {
  if (typeof value !== "bigint") throw new Error(`${value === null ? "an absent value" : value} is no number`);
  return value;
}

function truth(value) {
  if (typeof value !== "boolean") throw new Error(`${value === null ? "an absent value" : value} is neither true nor false`);
  return value;
}
