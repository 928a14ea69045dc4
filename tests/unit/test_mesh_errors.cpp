// Mistakes in mesh files: each is told with its place and what was expected, and no bytes stop the program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <random>

#include "support/mesh_files.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::out_of_range("no \"" + from + "\" in the text");
  return text.replace(at, from.size(), to);
}

const std::string gmsh_head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string gmsh_mesh = gmsh_head +
                              "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
                              "$Elements\n1\n1 4 2 3 7 1 2 3 4\n$EndElements\n";

TEST(GmshErrors, name_the_place_and_what_was_expected) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"3 0 1 0\n", "3 0 x 0\n",
       "a.msh:8:5: error: a node in $Nodes cannot be read from here on; expected number x y z"},
      {"3 0 1 0\n", "3 0 1 0 5\n", "a.msh:8:8: error: a node in $Nodes cannot be read"},
      {"3 0 1 0\n", "3 0 nan 0\n", "a.msh:8:5: error: a node in $Nodes cannot be read"},
      {"3 0 1 0\n", "3 0 1\n", "a.msh:8:6: error: a node in $Nodes cannot be read"},
      {"3 0 1 0\n", "2 0 1 0\n", "a.msh:8:1: error: node 2 is there twice; expected different numbers"},
      {"4 0 0 1\n", "", "a.msh:9:1: error: $Nodes ends after 3 nodes; expected 4"},
      {"\n4\n", "\n3\n", "a.msh:9:1: error: $Nodes goes on; expected $EndNodes after what it counts"},
      {"\n4\n", "\n-4\n",
       "a.msh:5:1: error: the number of nodes in $Nodes is -4, which the rest of the file cannot hold"},
      {"\n4\n", "\n4000000000000\n", "is 4000000000000, which the rest of the file cannot hold"},
      {"7 1 2 3 4", "7 1 2 3 9",
       "a.msh:13:16: error: element 1 has node 9, which $Nodes does not have; expected a number from there"},
      {"1 4 2 3", "1 11 2 3",
       "a.msh:13:1: error: this is a tetrahedron of 10 nodes (type 11), of higher order; expected elements of first "
       "order (in Gmsh: Mesh.ElementOrder = 1)"},
      {"1 4 2 3", "1 777 2 3", "elements of type 777 are not known; expected hexahedra (5)"},
      {"2.2 0 8", "4 0 8", "a.msh:2:1: error: the format of Gmsh is 4; expected 2.2 or 4.1"},
      {"$EndElements", "", "$Elements has no end; expected $EndElements"},
      {"$MeshFormat", "mesh", "this is no mesh of Gmsh 2.2 or 4.1; expected $MeshFormat in the first line"},
      {"$Nodes\n4", "$PartitionedEntities\n$EndPartitionedEntities\n$Nodes\n4", "the mesh is cut into partitions"},
      {"1 2 3 4\n", "1 2 3 4\n2 4 2 3 7 4 3 2 1\n", "a.msh:14:1: error: $Elements goes on"},
      {"$Elements\n1\n", "$Elements\n2\n2 4 2 3 7 4 3 2 1\n",
       "a.msh:14:1: error: element 1 has the nodes of element 2; expected one of them"}};
  for (const auto& [from, to, error] : cases)
    EXPECT_THAT(errors_of("a.msh", replaced(gmsh_mesh, from, to)), HasSubstr(error)) << to;
  EXPECT_EQ(errors_of("a.msh", gmsh_mesh), "");
}

TEST(GmshErrors, of_one_kind_are_told_twenty_times_and_then_counted) {
  std::string text = gmsh_head + "$Nodes\n50\n";
  for (int i = 0; i < 50; ++i) text += std::to_string(i) + " 0 0\n";
  const std::string errors = errors_of("a.msh", text + "$EndNodes\n$Elements\n0\n$EndElements\n");
  EXPECT_EQ(std::count(errors.begin(), errors.end(), '\n'), 21) << errors;
  EXPECT_THAT(errors, HasSubstr("a.msh: error: 30 more of the kind \"a node\""));
}

TEST(GmshErrors, of_binary_files_say_where_they_end) {
  const std::string whole = small_gmsh_mesh({41, true, false, false});
  EXPECT_THAT(errors_of("a.msh", whole.substr(0, whole.find("$EndElements") - 20)),
              HasSubstr("a.msh: error: an element in $Elements cannot be read"));
}

const std::string abaqus_mesh =
    "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=E\n9,1,2,3,4\n*NSET,NSET=N\n1,2\n"
    "*SOLID SECTION,ELSET=E\n";

TEST(AbaqusErrors, name_the_place_and_what_was_expected) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"3,0,1,0", "3,0,a,0",
       "a.inp:4:5: error: this line of nodes cannot be read from here on; expected number, x, y, z"},
      {"3,0,1,0", "3,0,1e999,0", "a.inp:4:5: error: this line of nodes"},
      {"3,0,1,0", "0,0,1,0", "a.inp:4:1: error: the number is 0; expected 1 to 2147483647"},
      {"3,0,1,0", "2,0,1,0", "a.inp:4:1: error: node 2 is there twice"},
      {"9,1,2,3,4", "9,1,2,3", "a.inp:7:1: error: an element of type C3D4 has 3 nodes; expected 4"},
      {"9,1,2,3,4", "9,1,2,3,4,5", "a.inp:7:11: error: this line of elements cannot be read from here on"},
      {"9,1,2,3,4", "9,1,2,3,5",
       "a.inp:7:1: error: element 9 has node 5, which does not exist; expected a number from *NODE"},
      {"9,1,2,3,4", "9,1,2,3,4\n9,4,3,2,1", "a.inp:8:1: error: element 9 is there twice"},
      {"C3D4", "C3D10M", "a.inp:6:1: error: elements of type C3D10M are not of first order; expected C3D8"},
      {"C3D4", "S4", "the mesh has no solid elements"},
      {"\n1,2\n", "\n1,7\n", "a.inp:9:3: error: set \"N\" has node 7, which does not exist"},
      {"\n1,2\n", "\n1,M\n", "a.inp:9:3: error: there is no set of nodes \"M\" above"},
      {"SECTION,ELSET=E", "SECTION,ELSET=F", "a.inp:10:1: error: there is no set of elements \"F\" above"},
      {"SECTION,ELSET=E", "SECTION", "*SOLIDSECTION has no ELSET; expected ELSET=name"},
      {"*NSET", "*INCLUDE, INPUT=b.inp\n*NSET", "a.inp:8:1: error: *INCLUDE is not taken; expected the text"},
      {"*NSET", "*SYSTEM\n1,2,3\n*NSET", "*SYSTEM is not taken; expected nodes in the global frame"},
      {"*NODE", "*NODE, SYSTEM=C", "*NODE has coordinates of SYSTEM=C; expected SYSTEM=R"},
      {"*NSET", "*SURFACE,NAME=S\nE,S5\n*NSET", "a.inp:9:1: error: element 9 has no face S5"},
      {"*NSET", "*PART,NAME=P\n*END PART\n*NSET", "no part has an instance"},
      {"*NSET", "*INSTANCE,NAME=I,PART=P\n*END INSTANCE\n*NSET", "a.inp:8:1: error: there is no part \"P\""},
      {"*SOLID", "*SOLID SECTION,ELSET=E\n*SOLID", "element 9 is in the blocks \"E\" and \"E\"; expected one"}};
  for (const auto& [from, to, error] : cases)
    EXPECT_THAT(errors_of("a.inp", replaced(abaqus_mesh, from, to)), HasSubstr(error)) << to;
  EXPECT_EQ(errors_of("a.inp", abaqus_mesh), "");
}

TEST(ExodusErrors, name_what_is_wrong) {
  const std::string whole = bytes_of(sample_path("shapes_cdf1.exo"));
  EXPECT_THAT(errors_of("a.exo", whole.substr(0, 300)),
              HasSubstr("a.exo: error: the header of the netCDF file is broken"));
  EXPECT_THAT(errors_of("a.exo", whole.substr(0, whole.size() - 600)), HasSubstr("cannot be read"));
  EXPECT_THAT(errors_of("a.exo", replaced(whole, "coord", "koord")),
              HasSubstr("the coordinates of nodes cannot be read"));
  EXPECT_THAT(errors_of("a.exo", replaced(whole, "TETRA4", "HEX888")),
              HasSubstr("has elements \"HEX888\" of 4 nodes; expected elements of first order"));
  const std::string four = bytes_of(sample_path("shapes_nc4.exo"));
  EXPECT_THAT(errors_of("a.exo", four.substr(0, 1000)), HasSubstr("a.exo: error: HDF5 cannot open the file"));
}

// ---- broken bytes ----------------------------------------------------------------------------------------------

/// One of: cut off, letters changed, lines exchanged, a number made huge, a piece written twice.
std::string broken(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  const auto line_at = [&](std::size_t at) {
    const std::size_t begin = text.rfind('\n', at), end = text.find('\n', at);
    return std::pair(begin == std::string::npos ? 0 : begin + 1, end == std::string::npos ? text.size() : end);
  };
  const std::size_t head = std::min<std::size_t>(text.size(), 3000);
  switch (below(6)) {
    case 0:
      return text.substr(0, below(text.size()));
    case 1:
      for (std::size_t i = 0, n = 1 + below(8); i < n; ++i) text[below(text.size())] = static_cast<char>(random());
      return text;
    case 2:  // counts stand at the beginning
      for (std::size_t i = 0, n = 1 + below(4); i < n; ++i) text[below(head)] = static_cast<char>(random());
      return text;
    case 3: {
      const auto [begin, end] = line_at(below(text.size()));
      const std::string line = text.substr(begin, end - begin);
      text.erase(begin, end - begin);
      return text.insert(below(text.size() + 1), line + "\n");
    }
    case 4: {
      const std::size_t at = text.find_first_of("0123456789", below(2) == 0 ? below(head) : below(text.size()));
      const char* huge[] = {"99999999", "9223372036854775807", "-1", "1e308", "4294967295"};
      return at == std::string::npos ? text : text.replace(at, 1, huge[below(5)]);
    }
    default: {
      const std::size_t from = below(text.size()), n = below(200);
      return text.insert(below(text.size()), text.substr(from, n));
    }
  }
}

void expect_survival(const std::string& name, const std::string& whole, int n) {
  std::mt19937 random(20261128);
  double slowest = 0.0;
  int refused = 0;
  for (int i = 0; i < n; ++i) {
    const std::string text = broken(whole, random);
    const auto start = std::chrono::steady_clock::now();
    refused += errors_of(name, text).empty() ? 0 : 1;
    slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  EXPECT_LT(slowest, 1.0) << name;
  EXPECT_GT(refused, n / 4) << name;  // the rest changes names, coordinates or comments
}

class BrokenBytes : public testing::TestWithParam<const char*> {};

TEST_P(BrokenBytes, stop_no_reader) { expect_survival(GetParam(), bytes_of(sample_path(GetParam())), 2000); }

INSTANTIATE_TEST_SUITE_P(MeshFiles, BrokenBytes,
                         testing::Values("bar_and_plate_v22.msh", "bar_and_plate_v41.msh",
                                         "bar_and_plate_v41_binary.msh", "Tensile.inp", "jc_ti64_abq_builtin.inp",
                                         "sphere_plate_contact.g", "cubes_contact.g", "wave_in_bar.g",
                                         "shapes_cdf1.exo", "shapes_cdf5.exo"));

TEST(BrokenBytesOfGmsh, stop_no_reader_in_any_order_of_bytes) {
  for (const int version : {22, 41})
    for (const bool swapped : {false, true})
      expect_survival("a.msh", small_gmsh_mesh({version, true, swapped, true}), 2000);
}

}  // namespace
