// Turns the events of yaml-cpp's parser into nodes. Events rather than its tree: they carry the place of every
// key, and the tree would let a second key of the same name pass.
#include "input/yaml_reader.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <utility>

#include "core/units.hpp"

namespace kerf {
namespace {

// Aliases of aliases can make a small file expand without bound.
constexpr std::size_t most_nodes = 200'000;

std::size_t count_nodes(const Node& node) {
  std::size_t n = 1;
  for (const Node& item : node.items) n += count_nodes(item);
  for (const Entry& entry : node.entries) n += count_nodes(entry.value);
  return n;
}

class TreeBuilder final : public YAML::EventHandler {
 public:
  TreeBuilder(const std::string& file_name, Diagnostics& diagnostics)
      : file_(std::make_shared<const std::string>(file_name)), diagnostics_(diagnostics) {}

  /// Where the last document began.
  const Origin& document() const { return document_; }
  Node take_root() { return std::move(root_); }
  Origin origin(const YAML::Mark& mark) const { return {file_, mark.line + 1, mark.column + 1}; }

  void OnDocumentStart(const YAML::Mark& mark) override { document_ = origin(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node node;
    node.origin = origin(mark);
    finish(std::move(node), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchored_.find(anchor);
    if (found == anchored_.end()) {
      diagnostics_.error(origin(mark), "the alias stands inside the value it refers to; aliases must come after it");
      return finish(Node{}, 0);
    }
    n_nodes_ += count_nodes(found->second);
    if (n_nodes_ > most_nodes) throw YAML::ParserException(mark, "the aliases expand to too many values");
    finish(Node(found->second), 0);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_tag(mark, tag);
    Node node;
    node.kind = Node::Kind::scalar;
    node.origin = origin(mark);
    node.text = value;
    const bool quoted = tag == "!";
    if (!quoted && (value == "~" || value == "null")) node.kind = Node::Kind::nothing;
    finish(std::move(node), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Node::Kind::list, mark, tag, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Node::Kind::map, mark, tag, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    Node node;
    YAML::anchor_t anchor = 0;
    bool has_key = false;
    Node key;
  };

  // "?" and "!" are what the parser reports for plain and quoted scalars.
  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?" && tag != "!")
      diagnostics_.error(origin(mark), fmt::format("the tag \"{}\" has no meaning here; leave it out", tag));
  }

  void open(Node::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    refuse_tag(mark, tag);
    Open opened;
    opened.node.kind = kind;
    opened.node.origin = origin(mark);
    opened.anchor = anchor;
    stack_.push_back(std::move(opened));
  }
  void close() {
    Open closed = std::move(stack_.back());
    stack_.pop_back();
    finish(std::move(closed.node), closed.anchor);
  }

  // A complete node becomes the root, an item, a key, or the value of the key before it.
  void finish(Node node, YAML::anchor_t anchor) {
    ++n_nodes_;
    if (anchor != 0) anchored_[anchor] = node;
    if (stack_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = stack_.back();
    if (parent.node.is_list()) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.has_key) {
      parent.key = std::move(node);
      parent.has_key = true;
    } else {
      add_entry(parent, std::move(node));
      parent.has_key = false;
    }
  }

  void add_entry(Open& parent, Node value) {
    const Node& key = parent.key;
    if (!key.is_scalar()) {
      diagnostics_.error(key.origin, fmt::format("{} stands where a key belongs", key.what()));
      return;
    }
    if (const Entry* first = parent.node.find(key.text)) {
      diagnostics_.error(key.origin, fmt::format("`{}` is given twice; it stands in line {} already", key.text,
                                                 first->key_origin.line));
      return;
    }
    if (value.is_nothing()) value.origin = key.origin;
    parent.node.entries.push_back({key.text, key.origin, std::move(value)});
  }

  std::shared_ptr<const std::string> file_;
  Diagnostics& diagnostics_;
  Node root_;
  Origin document_;
  std::vector<Open> stack_;
  std::map<YAML::anchor_t, Node> anchored_;
  std::size_t n_nodes_ = 0;
};

std::string line_of(const std::string& text, int line) {
  std::istringstream stream(text);
  std::string found;
  for (int i = 0; i <= line && std::getline(stream, found); ++i) {
  }
  return found;
}

// What most often lies behind a syntax error, where the line shows it.
std::string hint(const std::string& line, const std::string& message) {
  if (line.find('\t') != line.npos) return "; indent with spaces, YAML does not allow tabs";
  for (std::size_t close = line.find(']'); close != line.npos; close = line.find(']', close + 1)) {
    const std::string_view rest = std::string_view(line).substr(close + 1);
    const std::string_view unit = trimmed(rest.substr(0, rest.find_first_of(",]}#:")));
    const std::size_t open = line.rfind('[', close);
    if (!unit.empty() && open != line.npos)
      return fmt::format("; a list followed by a unit must be quoted, for example \"{} {}\"",
                         line.substr(open, close + 1 - open), unit);
  }
  if (message.find("flow") != message.npos) return "; every [ and { needs its ] or }";
  if (message == "illegal map value" || message == "end of map not found")
    return "; the keys of a block begin in one column, and a text that holds a colon and a space must be quoted";
  return {};
}

}  // namespace

std::optional<Node> read_yaml(const std::string& file_name, const std::string& text, Diagnostics& diagnostics) {
  TreeBuilder builder(file_name, diagnostics);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return Node{};
    Node root = builder.take_root();
    if (parser && parser.HandleNextDocument(builder))
      diagnostics.error(builder.document(),
                        "a second YAML document begins; expected one only, without `---` in between");
    return root;
  } catch (const YAML::Exception& e) {
    const YAML::Mark mark = e.mark.is_null() ? YAML::Mark() : e.mark;
    diagnostics.error(builder.origin(mark), "not valid YAML: " + e.msg + hint(line_of(text, mark.line), e.msg));
    return std::nullopt;
  }
}

}  // namespace kerf
