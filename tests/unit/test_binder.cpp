// Requirement: what a type declares is what the input may say; everything else is an error with its place, all of
// them at once.
#include "input/binder.hpp"

#include <gtest/gtest.h>

#include "input/json_schema.hpp"
#include "input/reference_writer.hpp"
#include "input/yaml_reader.hpp"
#include "plugin/loader.hpp"

namespace {

using namespace kerf;
using Lines = std::vector<std::string>;

struct Law : Plugin {};

struct Steel final : Law {
  double yield = 0.0, exponent = 0.0;
  struct State {
    double damage;
  };
  static void describe(Schema<Steel>& s) {
    s.real(&Steel::yield, "yield", "Pa", positive, "yield stress");
    s.real(&Steel::exponent, "exponent", "-", fraction, "hardening exponent").by_default("0.2");
    s.rule("exponent", "a soft steel has an exponent of at most 0.5",
           [](const Steel& m) { return m.yield > 1e8 || m.exponent <= 0.5; });
    s.state(&State::damage, "damage", "-", 0.0, "damage");
  }
};

struct Inner {
  std::string name;
  double angle = -1.0;
  std::unique_ptr<Law> law;
  static void describe(Schema<Inner>& s) {
    s.real(&Inner::angle, "angle", "rad", any_value, "an angle").by_default("90 deg");
    s.plugin(&Inner::law, "law", "law", "a law").by_default("{type: steel, yield: 1 MPa}");
  }
};

struct Outer {
  double density = 0.0, speed = 1.0;
  std::int64_t cycles = 0;
  bool on = false;
  std::string mode, title;
  Vec3 velocity;
  std::vector<double> times;
  std::vector<std::string> names;
  Inner inner;
  std::vector<std::unique_ptr<Inner>> parts, steps;
  std::vector<std::unique_ptr<Law>> laws, named;
  static void describe(Schema<Outer>& s) {
    s.real(&Outer::density, "density", "kg/m3", positive, "density of the material");
    s.real(&Outer::speed, "speed", "m/s", any_value, "a speed").optional();
    s.integer(&Outer::cycles, "cycles", positive, "number of cycles").optional();
    s.boolean(&Outer::on, "on", "whether it is on").by_default("true");
    s.choice(&Outer::mode, "mode", {"keep", "drop", "drop_beyond"}, "what is done").by_default("keep");
    s.text(&Outer::title, "title", "a title").by_default("");
    s.vector(&Outer::velocity, "velocity", "m/s", any_value, "initial velocity").by_default("[0, 0, 3] mm/s");
    s.reals(&Outer::times, "times", "s", non_negative, "some times").optional();
    s.texts(&Outer::names, "names", "some names").optional();
    s.block(&Outer::inner, "inner", "a block").by_default("{}");
    s.block_map(&Outer::parts, "parts", "parts by name").optional();
    s.block_list(&Outer::steps, "steps", "steps in order").optional();
    s.plugin_list(&Outer::laws, "laws", "law", "laws").optional();
    s.plugin_map(&Outer::named, "named", "law", "laws by name").optional();
  }
};

class Binding : public testing::Test {
 protected:
  Binding() { registry.add_type<Steel>("law", "steel", "a law for tests", "test_binder.cpp"); }

  // Density is required, so that most texts need not mention it.
  void bind(const std::string& text) {
    const Node root = read_yaml("a.yaml", text, diagnostics).value_or(Node{});
    const Origin top{std::make_shared<const std::string>("a.yaml"), 1, 1};
    Binder(registry, diagnostics, origins).bind_block(Schema<Outer>::described<Outer>(), root, &outer, "", top);
  }
  Lines errors(const std::string& text) {
    bind("density: 1\n" + text);
    return diagnostics.errors();
  }

  Registry registry;
  Diagnostics diagnostics;
  OriginMap origins;
  Outer outer;
};

TEST_F(Binding, takes_values_with_units) {
  bind("density: 7.8 g/cm3\nspeed: 2 km/s\ncycles: 1e3\non: false\nmode: drop\ntitle: Rod on plate\n");
  EXPECT_EQ(diagnostics.errors(), Lines{});
  EXPECT_DOUBLE_EQ(outer.density, 7800.0);
  EXPECT_DOUBLE_EQ(outer.speed, 2000.0);
  EXPECT_EQ(outer.cycles, 1000);
  EXPECT_FALSE(outer.on);
  EXPECT_EQ(outer.mode, "drop");
  EXPECT_EQ(outer.title, "Rod on plate");
}

TEST_F(Binding, binds_defaults_like_user_text) {
  bind("density: 1");
  EXPECT_EQ(diagnostics.errors(), Lines{});
  EXPECT_TRUE(outer.on);
  EXPECT_EQ(outer.mode, "keep");
  EXPECT_DOUBLE_EQ(outer.velocity.z, 0.003);
  EXPECT_NEAR(outer.inner.angle, 1.5707963267948966, 1e-15);
  const auto* steel = dynamic_cast<const Steel*>(outer.inner.law.get());
  ASSERT_TRUE(steel);
  EXPECT_DOUBLE_EQ(steel->yield, 1e6);
  EXPECT_DOUBLE_EQ(steel->exponent, 0.2);
}

TEST_F(Binding, leaves_optional_values_untouched) {
  bind("density: 1");
  EXPECT_EQ(outer.speed, 1.0);
  EXPECT_TRUE(outer.times.empty());
  EXPECT_TRUE(outer.parts.empty());
}

TEST_F(Binding, takes_vectors_in_every_spelling) {
  for (const char* text : {"[0, 0, -1646]", "[0 m/s, 0 m/s, -1.646 km/s]", "[0, 0, -1646 m/s]", "0 0 -1646 m/s",
                           "\"[0, 0, -1.646] km/s\"", "0, 0, -1646", "\"[0, 0, -1646 m/s]\""}) {
    EXPECT_EQ(errors("velocity: " + std::string(text)), Lines{}) << text;
    EXPECT_DOUBLE_EQ(outer.velocity.z, -1646.0) << text;
  }
}

TEST_F(Binding, takes_lists_of_numbers_and_texts) {
  EXPECT_EQ(errors("times: 1 2 3 us\nnames: rod\n"), Lines{});
  EXPECT_EQ(outer.times.size(), 3u);
  EXPECT_DOUBLE_EQ(outer.times[2], 3e-6);
  EXPECT_EQ(outer.names, Lines{"rod"});
}

TEST_F(Binding, fills_named_blocks_and_plugins) {
  EXPECT_EQ(errors("parts:\n  rod: {angle: 1}\n  plate:\nlaws:\n  - {type: steel, yield: 2}\n"
                   "named:\n  soft: {type: steel, yield: 3}\n"),
            Lines{});
  ASSERT_EQ(outer.parts.size(), 2u);
  EXPECT_EQ(outer.parts[0]->name, "rod");
  EXPECT_EQ(outer.parts[0]->angle, 1.0);
  EXPECT_EQ(outer.parts[1]->name, "plate");
  ASSERT_EQ(outer.laws.size(), 1u);
  EXPECT_EQ(outer.laws[0]->type, "steel");
  EXPECT_EQ(outer.laws[0]->origin, "a.yaml:6:5");
  EXPECT_EQ(outer.laws[0]->description, registry.find("law", "steel"));
  ASSERT_EQ(outer.named.size(), 1u);
  EXPECT_EQ(outer.named[0]->label, "soft");
  EXPECT_EQ(outer.named[0]->origin, "a.yaml:8:3");
  EXPECT_EQ(origins.find("parts.rod.angle").text(), "a.yaml:3:16");
  EXPECT_EQ(origins.find("laws[0].yield").text(), "a.yaml:6:26");
}

TEST_F(Binding, reports_all_errors_at_once) {
  bind("spede: 3\nmode: dorp\ncycles: -4\n");
  EXPECT_EQ(diagnostics.errors(),
            (Lines{"a.yaml:1:1: error: unknown key `spede`; did you mean `speed`?",
                   "a.yaml:1:1: error: the required key `density` is missing; expected a density in kg/m3: density of "
                   "the material",
                   "a.yaml:3:9: error: `cycles` = -4 is out of range; expected greater than 0",
                   "a.yaml:2:7: error: `mode`: \"dorp\" is not a choice; did you mean `drop`?"}));
}

struct Case {
  const char *name, *text;
  Lines errors;
};
class Message : public Binding, public testing::WithParamInterface<Case> {};

TEST_P(Message, is_verbatim) { EXPECT_EQ(errors(GetParam().text), GetParam().errors); }

INSTANTIATE_TEST_SUITE_P(
    Of, Message,
    testing::Values(
        Case{"unknown_key_far_from_all",
             "inner: {quux: 3}",
             {"a.yaml:2:9: error: unknown key `quux`; valid keys are angle and law"}},
        Case{"no_space_after_colon",
             "inner: {angle:3}",
             {"a.yaml:2:9: error: unknown key `angle:3`; a space must follow the colon"}},
        Case{
            "wrong_dimension",
            "speed: 5400 kg",
            {"a.yaml:2:8: error: `speed`: \"5400 kg\" has the wrong dimension; expected a velocity in m/s, for example "
             "5400 m/s"}},
        Case{"list_for_number", "speed: [1]", {"a.yaml:2:8: error: `speed` is a list; expected a velocity in m/s"}},
        Case{"no_value", "speed:", {"a.yaml:2:1: error: `speed` has no value; expected a velocity in m/s"}},
        Case{"fraction_for_integer",
             "cycles: 1.5",
             {"a.yaml:2:9: error: `cycles`: \"1.5\" is not a whole number; expected one without unit or fraction, for "
              "example 10"}},
        Case{"octal",
             "cycles: 010",
             {"a.yaml:2:9: error: `cycles`: \"010\" begins with a zero, which some programs take for an octal number; "
              "leave the zero out"}},
        Case{"yes_for_true", "on: yes", {"a.yaml:2:5: error: `on` is the text \"yes\"; expected true or false"}},
        Case{"choice_far_from_all",
             "mode: quux",
             {"a.yaml:2:7: error: `mode`: \"quux\" is not a choice; the choices are keep, drop and drop_beyond"}},
        Case{"two_numbers",
             "velocity: [1, 2]",
             {"a.yaml:2:11: error: `velocity` has 2 numbers; expected three, for example \"[1, 2, 3] m/s\""}},
        Case{
            "units_on_some",
            "velocity: [1, 2, 3 mm/s]",
            {"a.yaml:2:11: error: `velocity`: some numbers have a unit and others have none; expected a unit for each, "
             "or one after the whole list"}},
        Case{"list_range",
             "times: [1, -2]",
             {"a.yaml:2:12: error: `times` = -2 s is out of range; expected at least 0 s"}},
        Case{"text_for_block", "inner: 3", {"a.yaml:2:8: error: `inner` is the text \"3\"; expected a map"}},
        Case{"map_for_list",
             "laws: {type: steel, yield: 1}",
             {"a.yaml:2:7: error: `laws` is a map; expected a list of maps with `type:` (`kerf list law` shows the "
              "types)"}},
        Case{
            "bad_name",
            "parts: {9mm: {}}",
            {"a.yaml:2:9: error: `9mm` is no name; expected letters, digits and underscores, beginning with a letter"}},
        Case{"unknown_type",
             "inner: {law: {type: stele}}",
             {"a.yaml:2:21: error: there is no law of type \"stele\"; did you mean `steel`? (`kerf list law` shows "
              "all)"}},
        Case{"no_type",
             "inner: {law: {yield: 1}}",
             {"a.yaml:2:9: error: the required key `type` is missing; expected the name of one of `kerf list law`"}},
        Case{"text_for_plugin",
             "inner: {law: steel}",
             {"a.yaml:2:14: error: `law` is the text \"steel\"; expected a map such as {type: steel}"}},
        Case{"missing_key_of_plugin",
             "laws:\n  - type: steel",
             {"a.yaml:3:5: error: the required key `yield` is missing; expected a pressure in Pa: yield stress"}},
        Case{"range_of_plugin",
             "laws:\n  - {type: steel, yield: 0 Pa, exponent: 2}",
             {"a.yaml:3:26: error: `yield` = 0 Pa is out of range; expected greater than 0 Pa",
              "a.yaml:3:42: error: `exponent` = 2 is out of range; expected from 0 to 1"}},
        Case{"rule",
             "laws:\n  - type: steel\n    yield: 1 MPa\n    exponent: 0.9",
             {"a.yaml:5:5: error: `exponent`: a soft steel has an exponent of at most 0.5"}},
        Case{"rule_waits_for_values",
             "laws:\n  - {type: steel, yield: -1, exponent: 0.9}",
             {"a.yaml:3:26: error: `yield` = -1 Pa is out of range; expected greater than 0 Pa"}}),
    [](const testing::TestParamInfo<Case>& info) { return std::string(info.param.name); });

TEST_F(Binding, leaves_out_a_plugin_with_errors) {
  bind("density: 1\nlaws:\n  - {type: steel, yield: oops}\n  - {type: steel, yield: 2}\n");
  EXPECT_EQ(diagnostics.errors().size(), 1u);
  EXPECT_EQ(outer.laws.size(), 1u);
}

TEST_F(Binding, refuses_two_plugins_of_one_name) {
  try {
    registry.add_type<Steel>("law", "steel", "another", "other.cpp");
    FAIL() << "the second registration was accepted";
  } catch (const std::runtime_error& e) {
    EXPECT_STREQ(e.what(),
                 "two plugins of kind law are called \"steel\": one in test_binder.cpp, one in other.cpp; "
                 "rename one of them");
  }
}

TEST_F(Binding, describes_what_it_binds) {
  EXPECT_EQ(describe_text(*registry.find("law", "steel")),
            "steel (law): a law for tests\n"
            "declared in test_binder.cpp\n"
            "\nparameters\n"
            "  yield: number in Pa, greater than 0 Pa, required\n"
            "      yield stress\n"
            "  exponent: number, from 0 to 1, by default 0.2\n"
            "      hardening exponent\n"
            "  rule for exponent: a soft steel has an exponent of at most 0.5\n"
            "\nstate variables, kept for every point\n"
            "  damage: without unit, at first 0\n"
            "      damage\n");
  EXPECT_NE(describe_markdown(*registry.find("law", "steel"))
                .find("| `yield` | number | Pa | required | greater than 0 Pa | yield stress |"),
            std::string::npos);
  EXPECT_EQ(list_text(registry, "law"), "law\n  steel  a law for tests\n");
  EXPECT_NE(json_schema(registry).find("\"law.steel\""), std::string::npos);
}

TEST_F(Binding, loader_refuses_what_is_no_plugin) {
  load_plugin("no_such_file.so", registry, diagnostics);
  EXPECT_EQ(diagnostics.errors(),
            Lines{"no_such_file.so: error: there is no such plugin file; looked for no_such_file.so; expected a shared "
                  "library (.so), by its path or by its name in a folder of KERF_PLUGIN_PATH"});
}

struct Fragile final : Law {
  Fragile() { throw std::runtime_error("the table is missing"); }
  static void describe(Schema<Fragile>&) {}
};

TEST_F(Binding, a_constructor_that_throws_is_told_where_the_type_is_named) {
  registry.add_type<Fragile>("law", "fragile", "throws", "fragile.cpp");
  EXPECT_EQ(
      errors("inner:\n  law:\n    type: fragile\n"),
      Lines{"a.yaml:4:11: error: the constructor of the law fragile (fragile.cpp) has thrown an exception: the table "
            "is missing"});
}

}  // namespace
