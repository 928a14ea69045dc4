// What readers of meshes find wrong.
#include "mesh/mesh_errors.hpp"

namespace kerf {

MeshErrors::~MeshErrors() {
  for (const auto& [name, kind] : kinds_)
    if (kind.n > kind.most)
      diagnostics_.error(*file_, std::to_string(kind.n - kind.most) + " more of the kind \"" + name + "\"");
}

void MeshErrors::at(FilePlace place, const std::string& kind, const std::string& message, std::int64_t most) {
  ++count_;
  Kind& counted = kinds_[kind];
  counted.most = most;
  if (++counted.n <= most) diagnostics_.error(Origin{file_, place.line, place.column}, message);
}

void MeshErrors::warn(FilePlace place, const std::string& message) {
  if (++warnings_ <= 100) diagnostics_.warning(Origin{file_, place.line, place.column}, message);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t most = 40;
  std::string out = "\"";
  for (const char c : text.substr(0, most)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (text.size() > most ? "..." : "") + "\"";
}

}  // namespace kerf
