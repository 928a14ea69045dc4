// The one declaration of what a plugin (or a block of the input file) takes and keeps.
//
// A type that is read from input has `static void describe(Schema<T>&)`. From that declaration come
// parsing, unit conversion, range checks, error lines, reference pages, the JSON schema, and, for laws,
// allocation, migration, restart and output of their state variables.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "kerf/math.hpp"

namespace kerf {

class Curve;
class Description;
class Expression;

/// Base of everything that an input file can create by name.
struct Plugin {
  Plugin() = default;
  Plugin(const Plugin&) = delete;
  Plugin& operator=(const Plugin&) = delete;
  virtual ~Plugin() = default;

  std::string type;  // registered name
  std::string label;  // name given by the user, or empty
  std::string origin;  // "file:line:column" of the block that made it
  const Description* description = nullptr;  // what it declared; owned by the registry
};

/// Interval of allowed values, in SI units. Written so that NaN is outside every interval.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;

  constexpr bool contains(double v) const {
    return (low_open ? v > low : v >= low) && (high_open ? v < high : v <= high);
  }
};
inline constexpr Range any_value{};
inline constexpr Range positive{0.0, std::numeric_limits<double>::infinity(), true, true};
inline constexpr Range non_negative{0.0, std::numeric_limits<double>::infinity(), false, true};
inline constexpr Range fraction{0.0, 1.0, false, false};
constexpr Range between(double low, double high) { return {low, high, false, false}; }

enum class ValueKind {
  real,  // number with an optional unit
  integer,  //
  boolean,  // true / false
  text,  // free text or a name
  choice,  // one of `choices`
  vector,  // three numbers: "[1, 2, 3] mm" or [1 mm, 2 mm, 3 mm]
  reals,  // list of numbers
  integers,  // list of whole numbers
  texts,  // list of texts; a single text is a list of one
  text_map,  // map from a user's name to a text
  block,  // nested map described by `nested`
  block_list,  // list of maps described by `nested`
  block_map,  // map from a user's name to a map described by `nested`
  plugin,  // map with `type:` naming a plugin of kind `plugin_kind`
  plugin_list,  // list of plugins
  plugin_map,  // map from a user's name to a plugin
  curve,  // name of a curve in `curves`
  expression,  // a formula of the variables in `choices`, or of any where that is empty
  expressions,  // list of formulas
};

/// One key that may stand in a block of the input.
struct Parameter {
  std::string name;
  ValueKind kind = ValueKind::real;
  std::string unit;  // SI unit of the dimension, "-" where there is none
  std::string doc;  // one sentence, lower case, no full stop
  bool required = true;
  std::string default_text;  // as a user would write it; empty where absent means "not there"
  Range range;
  Range usual;  // outside of it a value is allowed, with a warning
  std::vector<std::string> choices;
  std::string plugin_kind;
  std::function<const Description&()> nested;

  // How a value, already in SI units, reaches the object at `target`; the one that fits `kind` is set.
  std::function<void(void* target, double)> set_real;
  std::function<void(void* target, std::int64_t)> set_integer;
  std::function<void(void* target, bool)> set_boolean;
  std::function<void(void* target, std::string)> set_text;  // also choice
  std::function<void(void* target, std::vector<double>)> set_reals;  // also vector (three)
  std::function<void(void* target, std::vector<std::int64_t>)> set_integers;
  std::function<void(void* target, std::vector<std::string>)> set_texts;
  std::function<void(void* target, const std::string& key, std::string)> set_named_text;
  /// Address of the nested object to fill, or of the Expression; `key` is the user's name in a block_map, else empty.
  std::function<void*(void* target, const std::string& key)> open_block;
  std::function<void(void* target, const std::string& key, std::unique_ptr<Plugin>)> set_plugin;
  std::function<void(void* target, const Curve*)> set_curve;
};

/// A quantity that a law keeps per point; the framework allocates, migrates, restarts and writes it.
struct StateVariable {
  std::string name, unit, doc;
  double initial = 0.0;
  int index = 0;  // position in the law's State, in doubles
  Range range = any_value;  // of what a user may set before the first step
  bool begins_tensor = false;  // the first of six components (xx, yy, zz, xy, yz, zx) that the element rotates
};

/// A quantity that a law reads from whichever other law of the element declares it as state.
struct ReadVariable {
  std::string name, doc;
  int index = 0;  // position in the law's Reads, in doubles
  bool is_optional = false;  // where no law declares it, `value` is read
  double value = 0.0;
  /// The name that the user gave; empty where the declaration fixes it.
  std::function<std::string(const Plugin&)> name_of = {};
};

/// A relation between parameters; `key` is the parameter whose line the message names.
struct Rule {
  std::string key, message;
  std::function<bool(const void*)> holds;
};

/// Everything declared about one type; plain data once built.
class Description {
 public:
  std::string kind, name, summary, origin;
  std::vector<Parameter> parameters;
  std::vector<StateVariable> state;
  std::vector<ReadVariable> reads;
  std::vector<Rule> rules;
};

/// Chained after a declaration to make a parameter optional or narrow it.
class ParameterHandle {
 public:
  explicit ParameterHandle(Parameter& p) : p_(&p) {}
  /// Not required; `text` is what stands in the manual and is parsed like a user's text.
  ParameterHandle& by_default(std::string text) {
    p_->required = false;
    p_->default_text = std::move(text);
    return *this;
  }
  /// Values outside of this interval are taken, with a warning.
  ParameterHandle& usual(Range range) {
    p_->usual = range;
    return *this;
  }
  /// Not required, and nothing is set where it is absent.
  ParameterHandle& optional() {
    p_->required = false;
    return *this;
  }

 private:
  Parameter* p_;
};

/// Chained after the declaration of a state variable.
class StateHandle {
 public:
  explicit StateHandle(StateVariable& v) : v_(&v) {}
  /// Values outside of this interval are refused in the input's block `initial_state`.
  StateHandle& within(Range range) {
    v_->range = range;
    return *this;
  }

 private:
  StateVariable* v_;
};

/// Chained after the declaration of a variable that is read.
class ReadHandle {
 public:
  explicit ReadHandle(ReadVariable& r) : r_(&r) {}
  /// Without a law that declares the variable, `value` is read; otherwise its absence is an error of the input.
  ReadHandle& by_default(double value) {
    r_->is_optional = true;
    r_->value = value;
    return *this;
  }

 private:
  ReadVariable* r_;
};

/// Filled by `T::describe`. Parameters are named by member pointers, so a name is typed once.
template <class T>
class Schema {
 public:
  explicit Schema(Description& d) : d_(d) {}

  /// One sentence that says what the plugin is for.
  void summary(std::string text) { d_.summary = std::move(text); }

  template <class Owner>
  ParameterHandle real(double Owner::*member, std::string name, std::string unit, Range range, std::string doc) {
    Parameter& p = add(ValueKind::real, std::move(name), std::move(unit), std::move(doc));
    p.range = range;
    p.set_real = [member](void* t, double v) { static_cast<T*>(t)->*member = v; };
    return ParameterHandle(p);
  }
  template <class Owner, class Int>
  ParameterHandle integer(Int Owner::*member, std::string name, Range range, std::string doc) {
    static_assert(std::is_integral_v<Int>);
    Parameter& p = add(ValueKind::integer, std::move(name), "-", std::move(doc));
    p.range = range;
    p.set_integer = [member](void* t, std::int64_t v) { static_cast<T*>(t)->*member = static_cast<Int>(v); };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle boolean(bool Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::boolean, std::move(name), "-", std::move(doc));
    p.set_boolean = [member](void* t, bool v) { static_cast<T*>(t)->*member = v; };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle text(std::string Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::text, std::move(name), "-", std::move(doc));
    p.set_text = [member](void* t, std::string v) { static_cast<T*>(t)->*member = std::move(v); };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle choice(std::string Owner::*member, std::string name, std::vector<std::string> choices,
                         std::string doc) {
    Parameter& p = add(ValueKind::choice, std::move(name), "-", std::move(doc));
    p.choices = std::move(choices);
    p.set_text = [member](void* t, std::string v) { static_cast<T*>(t)->*member = std::move(v); };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle vector(Vec3 Owner::*member, std::string name, std::string unit, Range range, std::string doc) {
    Parameter& p = add(ValueKind::vector, std::move(name), std::move(unit), std::move(doc));
    p.range = range;
    p.set_reals = [member](void* t, std::vector<double> v) { static_cast<T*>(t)->*member = Vec3{v[0], v[1], v[2]}; };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle reals(std::vector<double> Owner::*member, std::string name, std::string unit, Range range,
                        std::string doc) {
    Parameter& p = add(ValueKind::reals, std::move(name), std::move(unit), std::move(doc));
    p.range = range;
    p.set_reals = [member](void* t, std::vector<double> v) { static_cast<T*>(t)->*member = std::move(v); };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle integers(std::vector<std::int64_t> Owner::*member, std::string name, Range range, std::string doc) {
    Parameter& p = add(ValueKind::integers, std::move(name), "-", std::move(doc));
    p.range = range;
    p.set_integers = [member](void* t, std::vector<std::int64_t> v) { static_cast<T*>(t)->*member = std::move(v); };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle texts(std::vector<std::string> Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::texts, std::move(name), "-", std::move(doc));
    p.set_texts = [member](void* t, std::vector<std::string> v) { static_cast<T*>(t)->*member = std::move(v); };
    return ParameterHandle(p);
  }
  template <class Owner>
  ParameterHandle text_map(std::map<std::string, std::string> Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::text_map, std::move(name), "-", std::move(doc));
    p.set_named_text = [member](void* t, const std::string& key, std::string v) {
      (static_cast<T*>(t)->*member)[key] = std::move(v);
    };
    return ParameterHandle(p);
  }
  template <class Owner, class Block>
  ParameterHandle block(Block Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::block, std::move(name), "-", std::move(doc));
    p.nested = &described<Block>;
    p.open_block = [member](void* t, const std::string&) -> void* { return &(static_cast<T*>(t)->*member); };
    return ParameterHandle(p);
  }
  /// A block that may be absent; `member` is a pointer that is filled when the block is there.
  template <class Owner, class Block>
  ParameterHandle optional_block(std::unique_ptr<Block> Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::block, std::move(name), "-", std::move(doc));
    p.required = false;
    p.nested = &described<Block>;
    p.open_block = [member](void* t, const std::string&) -> void* {
      auto& slot = static_cast<T*>(t)->*member;
      slot = std::make_unique<Block>();
      return slot.get();
    };
    return ParameterHandle(p);
  }
  template <class Owner, class Block>
  ParameterHandle block_list(std::vector<std::unique_ptr<Block>> Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::block_list, std::move(name), "-", std::move(doc));
    p.nested = &described<Block>;
    p.open_block = [member](void* t, const std::string&) -> void* {
      auto& list = static_cast<T*>(t)->*member;
      list.push_back(std::make_unique<Block>());
      return list.back().get();
    };
    return ParameterHandle(p);
  }
  /// Blocks that the user names; `Block` has a member `std::string name`, set to the key.
  template <class Owner, class Block>
  ParameterHandle block_map(std::vector<std::unique_ptr<Block>> Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::block_map, std::move(name), "-", std::move(doc));
    p.nested = &described<Block>;
    p.open_block = [member](void* t, const std::string& key) -> void* {
      auto& list = static_cast<T*>(t)->*member;
      list.push_back(std::make_unique<Block>());
      list.back()->name = key;
      return list.back().get();
    };
    return ParameterHandle(p);
  }
  template <class Owner, class Base>
  ParameterHandle plugin(std::unique_ptr<Base> Owner::*member, std::string name, std::string kind, std::string doc) {
    Parameter& p = add(ValueKind::plugin, std::move(name), "-", std::move(doc));
    p.plugin_kind = std::move(kind);
    p.set_plugin = [member](void* t, const std::string&, std::unique_ptr<Plugin> made) {
      (static_cast<T*>(t)->*member).reset(dynamic_cast<Base*>(made.release()));
    };
    return ParameterHandle(p);
  }
  template <class Owner, class Base>
  ParameterHandle plugin_list(std::vector<std::unique_ptr<Base>> Owner::*member, std::string name, std::string kind,
                              std::string doc) {
    return plugins(ValueKind::plugin_list, member, std::move(name), std::move(kind), std::move(doc));
  }
  /// Plugins that the user names; the key is stored in `Plugin::label`.
  template <class Owner, class Base>
  ParameterHandle plugin_map(std::vector<std::unique_ptr<Base>> Owner::*member, std::string name, std::string kind,
                             std::string doc) {
    return plugins(ValueKind::plugin_map, member, std::move(name), std::move(kind), std::move(doc));
  }

  /// A named curve of the input, see kerf/curve.hpp. The member is null where an optional one is absent.
  template <class Owner>
  ParameterHandle curve(const Curve* Owner::*member, std::string name, std::string doc) {
    Parameter& p = add(ValueKind::curve, std::move(name), "-", std::move(doc));
    p.set_curve = [member](void* t, const Curve* c) { static_cast<T*>(t)->*member = c; };
    return ParameterHandle(p);
  }

  /// A formula in the variables of this list, or, where it is empty, in whatever variables it names; see
  /// kerf/expression.hpp, which the caller includes. `unit` is the SI unit of its value.
  template <class Owner>
  ParameterHandle expression(Expression Owner::*member, std::string name, std::string unit,
                             std::vector<std::string> variables, std::string doc) {
    Parameter& p = add(ValueKind::expression, std::move(name), std::move(unit), std::move(doc));
    p.choices = std::move(variables);
    p.open_block = [member](void* t, const std::string&) -> void* { return &(static_cast<T*>(t)->*member); };
    return ParameterHandle(p);
  }
  /// A list of formulas, of any length.
  template <class Owner>
  ParameterHandle expressions(std::vector<Expression> Owner::*member, std::string name, std::string unit,
                              std::vector<std::string> variables, std::string doc) {
    Parameter& p = add(ValueKind::expressions, std::move(name), std::move(unit), std::move(doc));
    p.choices = std::move(variables);
    p.open_block = [member](void* t, const std::string&) -> void* {
      return &(static_cast<T*>(t)->*member).emplace_back();
    };
    return ParameterHandle(p);
  }

  /// A state variable: a double of the law's `State`, which holds doubles, arrays of them and tensors, nothing else.
  template <class State>
  StateHandle state(double State::*member, std::string name, std::string unit, double initial, std::string doc) {
    d_.state.push_back({std::move(name), std::move(unit), std::move(doc), initial, index_of(member)});
    return StateHandle(d_.state.back());
  }
  /// Several doubles, called name_1, name_2, ...
  template <class State, std::size_t n>
  void state(double (State::*member)[n], const std::string& name, const std::string& unit, double initial,
             const std::string& doc) {
    const int first = index_of(member);
    for (int i = 0; i < static_cast<int>(n); ++i)
      d_.state.push_back({name + "_" + std::to_string(i + 1), unit, doc, initial, first + i});
  }
  /// A tensor that is zero at the start. The element rotates it with the material before it calls the law, as it does
  /// with the stress (Jaumann rate by the rotation of Hughes & Winget 1980).
  template <class State>
  void state(SymTensor State::*member, const std::string& name, const std::string& unit, const std::string& doc) {
    const int first = index_of(member);
    int i = 0;
    for (const char* component : {"_xx", "_yy", "_zz", "_xy", "_yz", "_zx"}) {
      d_.state.push_back({name + component, unit, doc, 0.0, first + i, any_value, i == 0});
      ++i;
    }
  }
  /// A double in the law's `Reads` that is filled from another law's state variable of that name. A material sees it as
  /// the last step left it, an equation of state after the material, a criterion after both; what
  /// another criterion keeps, a criterion sees as this step leaves it only if the other one stands before it.
  template <class Reads>
  ReadHandle reads(double Reads::*member, std::string name, std::string doc) {
    d_.reads.push_back({std::move(name), std::move(doc), index_of(member)});
    return ReadHandle(d_.reads.back());
  }
  /// The same for a variable that the user names: with the parameter of that name, which is declared apart.
  template <class Reads, class Owner>
  ReadHandle reads(double Reads::*member, std::string Owner::*name, std::string doc) {
    d_.reads.push_back({"", std::move(doc), index_of(member)});
    d_.reads.back().name_of = [name](const Plugin& p) { return static_cast<const T&>(p).*name; };
    return ReadHandle(d_.reads.back());
  }
  /// A relation between parameters, with the sentence that is printed where it does not hold.
  void rule(std::string key, std::string message, std::function<bool(const T&)> holds) {
    d_.rules.push_back({std::move(key), std::move(message),
                        [holds = std::move(holds)](const void* t) { return holds(*static_cast<const T*>(t)); }});
  }

  template <class Block>
  static const Description& described() {
    static const Description d = [] {
      Description made;
      made.kind = "block";
      Schema<Block> s(made);
      Block::describe(s);
      return made;
    }();
    return d;
  }

 private:
  Parameter& add(ValueKind kind, std::string name, std::string unit, std::string doc) {
    Parameter p;
    p.kind = kind;
    p.name = std::move(name);
    p.unit = std::move(unit);
    p.doc = std::move(doc);
    d_.parameters.push_back(std::move(p));
    return d_.parameters.back();
  }
  template <class Owner, class Base>
  ParameterHandle plugins(ValueKind kind, std::vector<std::unique_ptr<Base>> Owner::*member, std::string name,
                          std::string plugin_kind, std::string doc) {
    Parameter& p = add(kind, std::move(name), "-", std::move(doc));
    p.plugin_kind = std::move(plugin_kind);
    p.set_plugin = [member](void* t, const std::string& key, std::unique_ptr<Plugin> made) {
      made->label = key;
      (static_cast<T*>(t)->*member).emplace_back(dynamic_cast<Base*>(made.release()));
    };
    return ParameterHandle(p);
  }
  template <class Struct, class Member>
  static int index_of(Member Struct::*member) {
    static_assert(sizeof(Struct) % sizeof(double) == 0, "State and Reads hold doubles and nothing else");
    const Struct probe{};
    const auto* base = reinterpret_cast<const double*>(&probe);
    return static_cast<int>(reinterpret_cast<const double*>(&(probe.*member)) - base);
  }

  Description& d_;
};

}  // namespace kerf

KERF_SIZES(schema, KERF_SIZE(Plugin), KERF_SIZE(Range), KERF_SIZE(Parameter), KERF_SIZE(StateVariable),
           KERF_SIZE(ReadVariable), KERF_SIZE(Rule), KERF_SIZE(Description), KERF_SIZE(ParameterHandle),
           KERF_SIZE(StateHandle), KERF_SIZE(ReadHandle))
