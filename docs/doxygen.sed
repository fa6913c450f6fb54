# What many public types have alike is explained here once, for scripts/docs.
s|^  friend .*operator==(.*= default;|  /** Whether all members are equal. */ &|
s|^  friend .*operator<=>(.*= default;|  /** Orders by the members, the first one first. */ &|
s|^  \[\[nodiscard\]\] .* operator()(const Control& control) const;|  /** Computes the result. The worker calls this in a thread of its own. */ &|
# The C header has comments of C: those before a declaration, and those behind one.
1s|^/\*|/** \\file\n *|
# Fields that share a comment each get it.
s|^  \([a-z0-9_]*\) \([a-z_]*\), \([a-z_]*\); */\* \(.*\)|  \1 \2; /**< \4 \1 \3; /**< \4|
s|^  \([a-z0-9_]*\) \([a-z_]*\), \([a-z_]*\), \([a-z_]*\); */\* \(.*\)|  \1 \2; /**< \5 \1 \3; /**< \5 \1 \4; /**< \5|
s|^/\* ---- .* ---- \*/$||
s|^/\* |/** |
s|^\(  *[A-Za-z].*[;,0-9]\)  */\* |\1 /**< |
s#^\(WELKIN_\(API\|CALL\) .*;\)  */\* #\1 /**< #
s|^\(  *\)/\* |\1/** |
s|^  uint32_t struct_size;|  uint32_t struct_size; /**< sizeof the structure, as the caller has compiled it */|
