// Writes documents and meshes one value after another, and reads them back in the same order.
#include "lowering/lowered_bytes.hpp"

#include <cstring>
#include <map>
#include <type_traits>
#include <vector>

#include "core/assert.hpp"
#include "mesh/mesh_file.hpp"

namespace kerf::lowering {
namespace {

class Writer {
 public:
  std::string bytes;

  template <class Value>
  void put(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(const std::string& text) {
    put(text.size());
    bytes += text;
  }
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  template <class Value>
  void get(Value& value) {
    take(&value, sizeof value);
  }
  void get(std::string& text) {
    text.resize(size());
    take(text.data(), text.size());
  }
  std::size_t size() {
    std::size_t n = 0;
    get(n);
    return n;
  }

 private:
  void take(void* to, std::size_t n) {
    KERF_ASSERT(n <= bytes_.size() - at_, "a lowered deck that was packed by another program");
    if (n > 0) std::memcpy(to, bytes_.data() + at_, n);
    at_ += n;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

// ---- documents -------------------------------------------------------------------------------------------------

using Files = std::map<std::shared_ptr<const std::string>, std::int32_t>;

void put_origin(Writer& out, const Origin& origin, Files& files) {
  const auto [file, is_new] = files.emplace(origin.file, static_cast<std::int32_t>(files.size()));
  out.put(file->second);
  if (is_new) {
    out.put(origin.file != nullptr);
    out.put(origin.file ? *origin.file : std::string());
  }
  out.put(origin.line);
  out.put(origin.column);
}

void put_node(Writer& out, const Node& node, Files& files) {
  out.put(node.kind);
  put_origin(out, node.origin, files);
  out.put(node.text);
  out.put(node.items.size());
  for (const Node& item : node.items) put_node(out, item, files);
  out.put(node.entries.size());
  for (const Entry& entry : node.entries) {
    out.put(entry.key);
    put_origin(out, entry.key_origin, files);
    put_node(out, entry.value, files);
  }
}

using FileTable = std::vector<std::shared_ptr<const std::string>>;

void get_origin(Reader& in, Origin& origin, FileTable& files) {
  std::int32_t number = 0;
  in.get(number);
  if (static_cast<std::size_t>(number) == files.size()) {
    bool there = false;
    std::string name;
    in.get(there);
    in.get(name);
    files.push_back(there ? std::make_shared<const std::string>(name) : nullptr);
  }
  origin.file = files[static_cast<std::size_t>(number)];
  in.get(origin.line);
  in.get(origin.column);
}

void get_node(Reader& in, Node& node, FileTable& files) {
  in.get(node.kind);
  get_origin(in, node.origin, files);
  in.get(node.text);
  node.items.resize(in.size());
  for (Node& item : node.items) get_node(in, item, files);
  node.entries.resize(in.size());
  for (Entry& entry : node.entries) {
    in.get(entry.key);
    get_origin(in, entry.key_origin, files);
    get_node(in, entry.value, files);
  }
}

}  // namespace

std::string packed(const LoweredDeck& deck) {
  Writer out;
  Files files;
  put_node(out, deck.document, files);
  out.put(deck.mesh_name);
  out.put(kerf_mesh_bytes(*deck.mesh));
  return std::move(out.bytes);
}

LoweredDeck unpacked(const std::string& bytes) {
  Reader in(bytes);
  FileTable files;
  LoweredDeck deck;
  get_node(in, deck.document, files);
  in.get(deck.mesh_name);
  std::string mesh;
  in.get(mesh);
  Diagnostics diagnostics;
  deck.mesh = std::make_shared<FileMesh>(read_kerf_mesh({mesh, deck.mesh_name}, diagnostics));
  diagnostics.throw_if_errors();
  return deck;
}

}  // namespace kerf::lowering
