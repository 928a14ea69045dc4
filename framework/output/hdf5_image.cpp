// The bytes of HDF5's headers: superblock 2, object headers 2, compact groups, and version 1 B-trees of chunks.
//
// Names of sections are those of the "HDF5 File Format Specification".
#include "output/hdf5_image.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "output/checksum.hpp"

namespace kerf::hdf5 {

namespace {

constexpr std::uint64_t undefined = ~std::uint64_t{0};
constexpr std::size_t node_entries = 64;  // twice the K of chunk indices that readers assume

/// Bytes in the making, little-endian.
class Bytes {
 public:
  Bytes& number(std::uint64_t value, int n_bytes) {
    for (int i = 0; i < n_bytes; ++i) data_.push_back(static_cast<std::byte>(value >> (8 * i)));
    return *this;
  }
  Bytes& text(const std::string& text) { return raw(std::as_bytes(std::span(text))); }
  Bytes& raw(std::span<const std::byte> bytes) {
    data_.insert(data_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  std::size_t size() const { return data_.size(); }
  std::vector<std::byte>& data() { return data_; }
  const std::vector<std::byte>& data() const { return data_; }

 private:
  std::vector<std::byte> data_;
};

// ---- Messages of object headers (IV.A.2)

struct Message {
  std::uint8_t type;
  Bytes body;
};

Bytes dataspace(const std::vector<std::uint64_t>& size, bool grows) {
  Bytes b;
  b.number(2, 1).number(size.size(), 1).number(grows ? 1 : 0, 1).number(size.empty() ? 0 : 1, 1);
  for (const std::uint64_t n : size) b.number(n, 8);
  for (std::size_t i = 0; i < size.size() && grows; ++i) b.number(i == 0 ? undefined : size[i], 8);
  return b;
}

Bytes datatype(const Type& type) {
  Bytes b;
  constexpr std::uint64_t version = 1 << 4;
  const std::uint64_t bits = 8 * type.size;
  switch (type.kind) {
    case Kind::integer:
    case Kind::unsigned_integer:
      b.number(version | 0, 1).number(type.kind == Kind::integer ? 0x08 : 0, 3).number(type.size, 4);
      b.number(0, 2).number(bits, 2);
      break;
    case Kind::real: {
      const bool is_double = type.size == 8;
      // Bit field: the mantissa's first bit is implied; the sign is the last bit.
      b.number(version | 1, 1).number(0x20, 1).number(bits - 1, 1).number(0, 1).number(type.size, 4);
      b.number(0, 2).number(bits, 2);
      b.number(is_double ? 52 : 23, 1).number(is_double ? 11 : 8, 1);  // exponent: place and bits
      b.number(0, 1).number(is_double ? 52 : 23, 1);  // mantissa: place and bits
      b.number(is_double ? 1023 : 127, 4);  // bias
      break;
    }
    case Kind::text:
      b.number(version | 3, 1).number(1, 3).number(type.size, 4);  // padded with zeros, ASCII
      break;
  }
  return b;
}

Bytes attribute(const Attribute& a) {
  const Bytes type = datatype(a.type), space = dataspace(a.size, false);
  Bytes b;
  b.number(3, 1).number(0, 1).number(a.name.size() + 1, 2).number(type.size(), 2).number(space.size(), 2);
  b.number(0, 1).text(a.name).number(0, 1).raw(type.data()).raw(space.data()).raw(a.content);
  return b;
}

Bytes link(const std::string& name, std::uint64_t target) {
  Bytes b;
  constexpr std::uint64_t two_byte_length = 1, has_character_set = 0x10, utf8 = 1;
  b.number(1, 1).number(two_byte_length | has_character_set, 1).number(utf8, 1);
  return b.number(name.size(), 2).text(name).number(target, 8);
}

/// Version 2 object header with all messages in its first block.
Bytes object_header(const std::vector<Message>& messages) {
  Bytes body;
  for (const Message& m : messages) body.number(m.type, 1).number(m.body.size(), 2).number(0, 1).raw(m.body.data());
  Bytes b;
  constexpr std::uint64_t four_byte_size = 2;
  b.text("OHDR").number(2, 1).number(four_byte_size, 1).number(body.size(), 4).raw(body.data());
  return b.number(lookup3(b.data()), 4);
}

// ---- The image

class Builder {
 public:
  explicit Builder(std::uint64_t place) : place_(place) {}

  std::uint64_t store(Group& group) {
    constexpr std::uint8_t link_info = 0x02, link_message = 0x06, group_info = 0x0A, attribute_message = 0x0C;
    std::vector<Message> messages;
    messages.push_back({link_info, Bytes().number(0, 2).number(undefined, 8).number(undefined, 8)});
    messages.push_back({group_info, Bytes().number(0, 2)});
    for (auto& [name, child] : group.groups) messages.push_back({link_message, link(name, store(child))});
    for (auto& [name, child] : group.datasets) messages.push_back({link_message, link(name, store(child))});
    for (const Attribute& a : group.attributes) messages.push_back({attribute_message, attribute(a)});
    return put(object_header(messages).data());
  }

  Image finish(std::uint64_t root) { return {std::move(bytes_), root}; }

 private:
  std::uint64_t store(Dataset& dataset) {
    constexpr std::uint8_t space = 0x01, type = 0x03, fill = 0x05, layout = 0x08;
    // Storage is given out early for blocks and as needed for chunks; nothing is filled beforehand.
    constexpr std::uint64_t early = 1, as_needed = 3, never_filled = 1 << 2;
    const bool grows = dataset.chunk_rows > 0;
    std::vector<Message> messages;
    messages.push_back({space, dataspace(dataset.size, grows)});
    messages.push_back({type, datatype(dataset.type)});
    messages.push_back({fill, Bytes().number(3, 1).number((grows ? as_needed : early) | never_filled, 1)});
    messages.push_back({layout, grows ? chunked(dataset) : contiguous(dataset)});
    return put(object_header(messages).data());
  }

  Bytes contiguous(const Dataset& dataset) {
    const std::uint64_t n_bytes = dataset.n_entries() * dataset.type.size;
    std::uint64_t place = undefined;
    if (!dataset.content.empty())
      place = content_place(dataset.content);
    else if (n_bytes > 0 && !dataset.places.empty())
      place = dataset.places.front();
    return Bytes().number(3, 1).number(1, 1).number(place, 8).number(n_bytes, 8);
  }

  Bytes chunked(Dataset& dataset) {
    Bytes b;
    b.number(3, 1).number(2, 1).number(dataset.size.size() + 1, 1).number(store_index(dataset), 8);
    b.number(dataset.chunk_rows, 4);
    for (std::size_t i = 1; i < dataset.size.size(); ++i) b.number(dataset.size[i], 4);
    return b.number(dataset.type.size, 4);
  }

  /// Equal contents are stored once: most tables of VTKHDF's steps are alike.
  std::uint64_t content_place(const std::vector<std::byte>& content) {
    const std::string key(reinterpret_cast<const char*>(content.data()), content.size());
    const auto [found, is_new] = contents_.try_emplace(key, 0);
    if (is_new) found->second = put(content);
    return found->second;
  }

  /// Version 1 B-tree of the chunks (III.A.1), from the leaves up. Full leaves of earlier images are used again.
  std::uint64_t store_index(Dataset& dataset) {
    const std::size_t n_chunks = dataset.places.size();
    if (n_chunks == 0) return undefined;
    std::vector<std::uint64_t> level = dataset.full_nodes;
    for (std::size_t first = level.size() * node_entries; first < n_chunks; first += node_entries) {
      const std::size_t count = std::min(node_entries, n_chunks - first);
      level.push_back(put_node(dataset, 0, std::span(dataset.places).subspan(first, count), first, 1));
      if (count == node_entries) dataset.full_nodes.push_back(level.back());
    }
    std::uint64_t chunks_per_child = node_entries;
    for (int height = 1; level.size() > 1; ++height, chunks_per_child *= node_entries) {
      std::vector<std::uint64_t> above;
      for (std::size_t first = 0; first < level.size(); first += node_entries) {
        const std::size_t count = std::min(node_entries, level.size() - first);
        above.push_back(put_node(dataset, height, std::span(level).subspan(first, count), first, chunks_per_child));
      }
      level = std::move(above);
    }
    return level.front();
  }

  std::uint64_t put_node(const Dataset& dataset, int height, std::span<const std::uint64_t> children,
                         std::size_t first_child, std::uint64_t chunks_per_child) {
    constexpr std::uint64_t chunk_tree = 1;
    const std::uint64_t chunk_bytes = dataset.chunk_rows * dataset.row_bytes();
    Bytes b;
    b.text("TREE").number(chunk_tree, 1).number(static_cast<std::uint64_t>(height), 1).number(children.size(), 2);
    b.number(undefined, 8).number(undefined, 8);  // no neighbours: readers go from the root down
    const auto key = [&](std::uint64_t child) {
      const std::uint64_t chunk = std::min<std::uint64_t>(child * chunks_per_child, dataset.places.size());
      b.number(chunk_bytes, 4).number(0, 4).number(chunk * dataset.chunk_rows, 8);
      for (std::size_t i = 0; i < dataset.size.size(); ++i) b.number(0, 8);  // other dimensions, and the entry's bytes
    };
    for (std::size_t i = 0; i < children.size(); ++i) {
      key(first_child + i);
      b.number(children[i], 8);
    }
    key(first_child + children.size());
    const std::size_t key_size = 8 + 8 * (dataset.size.size() + 1);
    b.data().resize(24 + (node_entries + 1) * key_size + node_entries * 8);
    return put(b.data());
  }

  std::uint64_t put(const std::vector<std::byte>& bytes) {
    bytes_.resize((bytes_.size() + 7) / 8 * 8);
    const std::uint64_t place = place_ + bytes_.size();
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return place;
  }

  std::uint64_t place_;
  std::vector<std::byte> bytes_;
  std::map<std::string, std::uint64_t> contents_;
};

// ---- The description, packed

void pack_list(Bytes& b, const std::vector<std::uint64_t>& list) {
  b.number(list.size(), 8);
  for (const std::uint64_t n : list) b.number(n, 8);
}

void pack_text(Bytes& b, const std::string& text) { b.number(text.size(), 8).text(text); }

void pack_type(Bytes& b, const Type& type) { b.number(static_cast<std::uint64_t>(type.kind), 1).number(type.size, 4); }

void pack_dataset(Bytes& b, const Dataset& d) {
  pack_type(b, d.type);
  pack_list(b, d.size);
  b.number(d.chunk_rows, 8);
  pack_list(b, d.places);
  pack_list(b, d.full_nodes);
  b.number(d.pieces.size(), 8);
  for (const Piece& p : d.pieces) b.number(p.place, 8).number(p.size, 8).number(p.checksum, 8);
  b.number(d.content.size(), 8).raw(d.content);
}

void pack_group(Bytes& b, const Group& g) {
  b.number(g.attributes.size(), 8);
  for (const Attribute& a : g.attributes) {
    pack_text(b, a.name);
    pack_type(b, a.type);
    pack_list(b, a.size);
    b.number(a.content.size(), 8).raw(a.content);
  }
  b.number(g.datasets.size(), 8);
  for (const auto& [name, dataset] : g.datasets) {
    pack_text(b, name);
    pack_dataset(b, dataset);
  }
  b.number(g.groups.size(), 8);
  for (const auto& [name, group] : g.groups) {
    pack_text(b, name);
    pack_group(b, group);
  }
}

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : left_(bytes) {}

  Group group(int depth = 0) {
    if (depth > 16) refuse();
    Group g;
    for (std::uint64_t n = count(); n > 0; --n) {
      Attribute a;
      a.name = text();
      a.type = type();
      a.size = list();
      a.content = bytes();
      g.attributes.push_back(std::move(a));
    }
    for (std::uint64_t n = count(); n > 0; --n) {
      std::string name = text();
      g.datasets.emplace(std::move(name), dataset());
    }
    for (std::uint64_t n = count(); n > 0; --n) {
      std::string name = text();
      g.groups.emplace(std::move(name), group(depth + 1));
    }
    return g;
  }
  bool empty() const { return left_.empty(); }
  [[noreturn]] static void refuse() { throw std::runtime_error("the description of its contents makes no sense"); }

 private:
  std::uint64_t number(int n_bytes) {
    const auto from = take(static_cast<std::size_t>(n_bytes));
    std::uint64_t value = 0;
    std::memcpy(&value, from.data(), from.size());
    return value;
  }
  /// A number of things to follow, each at least a byte.
  std::uint64_t count() {
    const std::uint64_t n = number(8);
    if (n > left_.size()) refuse();
    return n;
  }
  std::span<const std::byte> take(std::uint64_t n) {
    if (n > left_.size()) refuse();
    const auto taken = left_.first(n);
    left_ = left_.subspan(n);
    return taken;
  }
  std::vector<std::byte> bytes() {
    const auto from = take(count());
    return {from.begin(), from.end()};
  }
  std::string text() {
    const auto from = take(count());
    return {reinterpret_cast<const char*>(from.data()), from.size()};
  }
  std::vector<std::uint64_t> list() {
    std::vector<std::uint64_t> values(count());
    for (std::uint64_t& v : values) v = number(8);
    return values;
  }
  Type type() {
    Type t;
    t.kind = static_cast<Kind>(number(1));
    t.size = static_cast<std::uint32_t>(number(4));
    return t;
  }
  Dataset dataset() {
    Dataset d;
    d.type = type();
    d.size = list();
    d.chunk_rows = number(8);
    d.places = list();
    d.full_nodes = list();
    d.pieces.resize(count());
    for (Piece& p : d.pieces) {
      p.place = number(8);
      p.size = number(8);
      p.checksum = number(8);
    }
    d.content = bytes();
    return d;
  }

  std::span<const std::byte> left_;
};

Attribute& attribute_named(Group& group, const std::string& name) {
  for (Attribute& a : group.attributes)
    if (a.name == name) return a;
  group.attributes.push_back({name, {}, {}, {}});
  return group.attributes.back();
}

std::vector<std::byte> bytes_of(std::span<const std::byte> bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

template <>
Type type_of<double>() {
  return {Kind::real, 8};
}
template <>
Type type_of<float>() {
  return {Kind::real, 4};
}
template <>
Type type_of<std::int64_t>() {
  return {Kind::integer, 8};
}
template <>
Type type_of<std::int32_t>() {
  return {Kind::integer, 4};
}
template <>
Type type_of<std::uint8_t>() {
  return {Kind::unsigned_integer, 1};
}

std::uint64_t Dataset::n_entries() const {
  std::uint64_t n = 1;
  for (const std::uint64_t s : size) n *= s;
  return n;
}

namespace {

/// The first value of an attribute of numbers.
template <class T>
T number_of(const Group& group, const std::string& name) {
  for (const Attribute& a : group.attributes) {
    if (a.name != name || a.type != type_of<T>() || a.content.size() < sizeof(T)) continue;
    T value{};
    std::memcpy(&value, a.content.data(), sizeof(T));
    return value;
  }
  throw std::runtime_error("there is no number named \"" + name + "\"");
}

}  // namespace

void Group::set(const std::string& name, std::int64_t value) {
  Attribute& a = attribute_named(*this, name);
  a.type = type_of<std::int64_t>();
  a.content = bytes_of(std::as_bytes(std::span(&value, 1)));
}

void Group::set_real(const std::string& name, double value) {
  Attribute& a = attribute_named(*this, name);
  a.type = type_of<double>();
  a.content = bytes_of(std::as_bytes(std::span(&value, 1)));
}

void Group::set(const std::string& name, const std::vector<std::int64_t>& values) {
  Attribute& a = attribute_named(*this, name);
  a.type = type_of<std::int64_t>();
  a.size = {values.size()};
  a.content = bytes_of(std::as_bytes(std::span(values)));
}

void Group::set(const std::string& name, const std::string& text) {
  Attribute& a = attribute_named(*this, name);
  a.type = {Kind::text, static_cast<std::uint32_t>(std::max<std::size_t>(1, text.size()))};
  a.content = bytes_of(std::as_bytes(std::span(text)));
  a.content.resize(a.type.size);
}

std::int64_t Group::integer(const std::string& name) const { return number_of<std::int64_t>(*this, name); }
double Group::real(const std::string& name) const { return number_of<double>(*this, name); }

Image build_image(Group& root, std::uint64_t place) {
  Builder builder(place);
  const std::uint64_t header = builder.store(root);
  return builder.finish(header);
}

std::vector<std::byte> superblock(std::uint64_t root, std::uint64_t file_size) {
  Bytes b;
  b.text("\x89HDF\r\n\x1a\n").number(2, 1).number(8, 1).number(8, 1).number(0, 1);
  b.number(0, 8).number(undefined, 8).number(file_size, 8).number(root, 8);
  b.number(lookup3(b.data()), 4);
  return std::move(b.data());
}

std::vector<std::byte> pack(const Group& root) {
  Bytes b;
  pack_group(b, root);
  return std::move(b.data());
}

Group unpack(std::span<const std::byte> bytes) {
  Unpacker unpacker(bytes);
  Group root = unpacker.group();
  if (!unpacker.empty()) Unpacker::refuse();
  return root;
}

}  // namespace kerf::hdf5
