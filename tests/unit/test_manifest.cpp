// How the manifest of a plugin is compared with this program's.
#include "plugin/manifest.hpp"

#include <gtest/gtest.h>

#include "kerf/plugin.hpp"

namespace {

using namespace kerf;

const std::string head = "interface=10\nkerf=1.2.3\nflags=-ffp-contract=off -fno-math-errno\n";

TEST(Manifest, is_equal_to_itself) {
  EXPECT_EQ(manifest_difference(own_manifest(), own_manifest()), "");
  EXPECT_NE(own_manifest().find("\nsize.schema.Plugin=" + std::to_string(sizeof(Plugin)) + "\n"), std::string::npos);
  EXPECT_FALSE(has_unknown_flags(own_manifest()));
}

TEST(Manifest, names_every_difference_with_both_values) {
  EXPECT_EQ(manifest_difference("interface=9\nkerf=1.2.2\nflags=-ffp-contract=off -fno-math-errno\n", head),
            "the interface version is 9 in the plugin and 10 here; Kerf's version is \"1.2.2\" in the plugin and "
            "\"1.2.3\" here");
}

TEST(Manifest, another_version_of_the_same_interface_fits) {
  EXPECT_EQ(manifest_difference("interface=10\nkerf=1.2.9\nflags=-ffp-contract=off -fno-math-errno\n", head), "");
}

TEST(Manifest, compares_the_sizes_of_the_headers_that_a_plugin_includes) {
  const std::string ours = head + "size.load.Load=8\nsize.load.LoadedNode=16\nsize.mesh.Mesh=24\n";
  EXPECT_EQ(manifest_difference(head + "size.load.Load=8\nsize.load.LoadedNode=16\n", ours), "");
  EXPECT_EQ(manifest_difference(head + "size.load.Load=8\nsize.load.LoadedNode=20\n", ours),
            "the size of LoadedNode is 20 in the plugin and 16 here");
  EXPECT_EQ(manifest_difference(head + "size.load.Load=8\n", ours),
            "the size of LoadedNode is not told in the plugin and 16 here");
  EXPECT_EQ(manifest_difference(head + "size.other.Thing=4\n", ours),
            "the size of Thing is 4 in the plugin and not told here");
}

TEST(Manifest, of_several_flags_for_one_thing_the_last_holds) {
  const auto with = [](const std::string& flags) { return "interface=10\nkerf=1.2.3\nflags=" + flags + "\n"; };
  EXPECT_EQ(manifest_difference(with("-ffp-contract=fast -fmath-errno -ffp-contract=off -fno-math-errno"), head), "");
  EXPECT_EQ(manifest_difference(with("-ffp-contract=off -fno-math-errno -ffp-contract=fast"), head),
            "the compile flags that differ are \"-ffp-contract=fast\" in the plugin and \"-ffp-contract=off\" here");
  EXPECT_EQ(manifest_difference(with("-ffp-contract=off -fno-math-errno -ffast-math"), head),
            "the compile flags that differ are \"-ffast-math\" in the plugin and \"none\" here");
  EXPECT_TRUE(has_unknown_flags(with("unknown")));
  EXPECT_TRUE(has_unknown_flags("interface=10\n"));
}

}  // namespace
