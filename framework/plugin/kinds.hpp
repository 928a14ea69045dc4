// The kinds of plugins that an input file can name: the one list that all others follow.
#pragma once

namespace kerf {

struct PluginKind {
  const char* name;
  const char* theory_page;  // of doc/theory, for the types that have no page of their own; null where there is none
};

/// In the order of the alphabet, as `kerf list` shows them.
inline constexpr PluginKind plugin_kinds[] = {
    {"balance_policy", "parallel"},
    {"boundary", "boundaries"},
    {"contact", "contact"},
    {"element", nullptr},
    {"eos", "eos"},
    {"erosion", "erosion"},
    {"load", "loads"},
    {"material", "materials"},
    {"measure", "measures"},
    {"mesh", nullptr},
    {"observer", "observers"},
    {"partitioner", "parallel"},
    {"solid", "solids"},
};

}  // namespace kerf
