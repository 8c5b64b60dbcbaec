# Bytes of stack that each function named by -v root='regular expression' can need with all it calls, deepest first, from the
# .ci files of g++ -fcallgraph-info=su,da. Fails on recursion, on a frame whose size depends on data, and on a call through a
# pointer, each of which would leave the depth unbounded. Functions without a .ci file (libgcc, memcpy) count nothing.

function field(name,   text) {
  text = $0
  if (!sub(".*" name ": \"", "", text)) return ""
  sub("\".*", "", text)
  return text
}

# A function that another file defines goes by its symbol alone.
function symbol(title) {
  sub(/^.*:/, "", title)
  return title
}

/^node:/ {
  title = field("title")
  label = field("label")
  if (match(label, /[0-9]+ bytes \((static|dynamic|dynamic,bounded)\)/)) {
    use = substr(label, RSTART, RLENGTH)
    size[title] = use + 0
    by_symbol[symbol(title)] = title
    readable[title] = label
    sub(/\\n.*/, "", readable[title])
    if (use ~ /\(dynamic\)/) bounded[title] = "no"
  }
}

/^edge:/ {
  from = field("sourcename")
  calls[from] = calls[from] " " field("targetname")
}

function complain(what, title) {
  if (!told[what title]++) print "UNBOUNDED: " readable[title] ": " what
  failed = 1
}

function depth(title,   targets, count, k, called, below, most) {
  if (title in known) return known[title]
  if (title in open) {
    complain("calls itself", title)
    return 0
  }
  open[title] = 1
  if (title in bounded) complain("has a frame whose size depends on data", title)
  most = 0
  count = split(calls[title], targets, " ")
  for (k = 1; k <= count; ++k) {
    called = targets[k]
    if (called == "__indirect_call") complain("calls through a pointer", title)
    if (!(called in size)) called = by_symbol[symbol(called)]
    if (called == "") continue
    below = depth(called)
    if (below > most) {
      most = below
      next_of[title] = called
    }
  }
  delete open[title]
  return known[title] = size[title] + most
}

END {
  for (title in size) {
    if (readable[title] !~ root) continue
    bytes = depth(title)
    line = sprintf("%6d %s", bytes, readable[title])
    if (verbose) {
      for (at = title; at in size; at = next_of[at]) line = line sprintf("\n              %5d %s", size[at], readable[at])
    }
    lines[++found] = line
    order[found] = bytes
  }
  for (i = 1; i <= found; ++i) {
    best = 0
    for (k = 1; k <= found; ++k) if (!(k in printed) && (!best || order[k] > order[best])) best = k
    printed[best] = 1
    print lines[best]
  }
  exit failed || !found
}
