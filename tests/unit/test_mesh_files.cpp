// Meshes of Gmsh, Abaqus and Exodus: nodes, cells, blocks, sets, volumes, against an independent reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "support/mesh_files.hpp"

namespace {

using namespace kerf;
using namespace kerf::test;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double precise = 1e-12;  // of a volume: sums of some hundred terms

nlohmann::json expected(const std::string& name) {
  return nlohmann::json::parse(bytes_of(sample_path("expected.json"))).at(name);
}

FileMesh sample(const std::string& name) {
  Diagnostics diagnostics;
  FileMesh mesh = read_mesh_file(sample_path(name), diagnostics);
  for (const std::string& error : diagnostics.errors()) ADD_FAILURE() << error;
  return mesh;
}

std::vector<double> box_of(const FileMesh& mesh) {
  std::vector<double> box(6);
  for (std::size_t k = 0; k < 3; ++k) {
    box[k] = 1e300, box[k + 3] = -1e300;
    for (const auto& x : mesh.points) box[k] = std::min(box[k], x[k]), box[k + 3] = std::max(box[k + 3], x[k]);
  }
  return box;
}

void expect_block(const FileMesh& mesh, const MeshBlock& block, const nlohmann::json& figures) {
  EXPECT_THAT(block.cells, SizeIs(figures.at("elements"))) << block.name;
  const double volume = figures.at("volume"), least = figures.at("min_volume");
  EXPECT_NEAR(volume_of(mesh, block.cells), volume, precise * volume) << block.name;
  double smallest = 1e300;
  for (const std::int32_t cell : block.cells) smallest = std::min(smallest, cell_volume(mesh, cell));
  EXPECT_NEAR(smallest, least, 1e-10 * least) << block.name;
}

/// The same mesh whatever the order of the file: nodes and cells by label.
std::map<std::string, std::vector<std::vector<std::int64_t>>> by_label(const FileMesh& mesh) {
  std::map<std::string, std::vector<std::vector<std::int64_t>>> all;
  const auto node = [&](std::int32_t n) { return mesh.node_labels.at(static_cast<std::size_t>(n)); };
  const auto cell = [&](std::int32_t c) { return mesh.cell_labels.at(static_cast<std::size_t>(c)); };
  for (const MeshBlock& block : mesh.blocks)
    for (const std::int32_t c : block.cells) {
      std::vector<std::int64_t> row{cell(c)};
      for (const std::int32_t n : mesh.cells[static_cast<std::size_t>(c)]) row.push_back(node(n));
      all["block " + block.name].push_back(row);
    }
  for (const MeshNodeSet& set : mesh.node_sets)
    for (const std::int32_t n : set.nodes) all["nodes " + set.name].push_back({node(n)});
  for (const MeshFaceSet& set : mesh.face_sets)
    for (const auto& face : set.faces)
      all["faces " + set.name].push_back({node(face[0]), node(face[1]), node(face[2]), node(face[3])});
  for (auto& [name, rows] : all) std::sort(rows.begin(), rows.end());
  return all;
}

std::map<std::int64_t, std::array<double, 3>> points_by_label(const FileMesh& mesh) {
  std::map<std::int64_t, std::array<double, 3>> all;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) all[mesh.node_labels[i]] = mesh.points[i];
  return all;
}

// ---- Gmsh ------------------------------------------------------------------------------------------------------

TEST(GmshFile, has_the_figures_of_an_independent_reader) {
  for (const char* name : {"bar_and_plate_v22.msh", "bar_and_plate_v41.msh", "bar_and_plate_v41_binary.msh"}) {
    const FileMesh mesh = sample(name);
    const nlohmann::json figures = expected(name);
    EXPECT_THAT(mesh.points, SizeIs(figures.at("nodes")));
    EXPECT_THAT(mesh.cells, SizeIs(figures.at("cells").at("hexahedron")));
    EXPECT_THAT(mesh.blocks, SizeIs(2));
    for (const MeshBlock& block : mesh.blocks) expect_block(mesh, block, figures.at("blocks").at(block.name));
    for (const MeshFaceSet& set : mesh.face_sets)
      EXPECT_THAT(set.faces, SizeIs(figures.at("blocks").at(set.name).at("elements"))) << set.name;
    EXPECT_EQ(mesh.block("plate 12 x 12")->label, 20);
    EXPECT_THAT(mesh.left_out, IsEmpty());
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(box_of(mesh)[k], figures.at("box")[k].get<double>(), 1e-12);
  }
}

TEST(GmshFile, is_the_same_mesh_in_three_formats) {
  const FileMesh v22 = sample("bar_and_plate_v22.msh"), v41 = sample("bar_and_plate_v41.msh");
  const FileMesh binary = sample("bar_and_plate_v41_binary.msh");
  EXPECT_EQ(v22.format, "Gmsh 2.2, text");
  EXPECT_EQ(binary.format, "Gmsh 4.1, binary");
  EXPECT_EQ(by_label(v41), by_label(binary));
  EXPECT_THAT(node_set(v41, "symmetry x").nodes, SizeIs(node_set(v22, "symmetry x").nodes.size()));
  // 2.2 numbers nodes and elements anew: they are compared by place.
  using Place = std::array<std::int64_t, 3>;
  const auto places = [](const FileMesh& mesh, const auto& nodes) {
    std::vector<Place> all;
    for (const std::int32_t n : nodes) {
      const auto& x = mesh.points[static_cast<std::size_t>(n)];
      all.push_back({std::llround(1e9 * x[0]), std::llround(1e9 * x[1]), std::llround(1e9 * x[2])});
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto cells = [&](const FileMesh& mesh, const std::string& block) {
    std::vector<std::vector<Place>> all;
    for (const std::int32_t c : mesh.block(block)->cells)
      all.push_back(places(mesh, mesh.cells[static_cast<std::size_t>(c)]));
    std::sort(all.begin(), all.end());
    return all;
  };
  for (const MeshNodeSet& set : v41.node_sets)
    EXPECT_EQ(places(v41, set.nodes), places(v22, node_set(v22, set.name).nodes)) << set.name;
  for (const MeshBlock& block : v41.blocks) EXPECT_EQ(cells(v41, block.name), cells(v22, block.name)) << block.name;
}

TEST(GmshFile, of_all_shapes_is_the_same_in_every_format_and_order_of_bytes) {
  const FileMesh first = read_sound("a.msh", small_gmsh_mesh({22, false, false, false}));
  for (const int version : {22, 41})
    for (const bool parametric : {false, true})
      for (const int bytes : {0, 1, 2}) {
        const FileMesh mesh = read_sound("a.msh", small_gmsh_mesh({version, bytes > 0, bytes == 2, parametric}));
        EXPECT_EQ(by_label(mesh), by_label(first)) << version << parametric << bytes;
        EXPECT_EQ(points_by_label(mesh), points_by_label(first)) << version << parametric << bytes;
        EXPECT_EQ(mesh.left_out, (std::map<std::string, std::int64_t>{{"line", 1}}));
      }
}

TEST(GmshFile, turns_all_shapes_into_hexahedra_of_positive_volume) {
  const FileMesh mesh = read_sound("a.msh", small_gmsh_mesh({41, true, true, true}));
  EXPECT_THAT(mesh.cell_labels, ElementsAre(500, 400, 300, 200));
  const double volumes[] = {1.0, 0.5, 1.0 / 3.0, 1.0 / 4.0};
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(cell_volume(mesh, c), volumes[c], 1e-14) << c;
  EXPECT_THAT(mesh.block("body")->cells, ElementsAre(0, 1, 2));
  EXPECT_THAT(mesh.block("tip")->cells, ElementsAre(3));
  EXPECT_THAT(face_set(mesh, "two faces").faces, ElementsAre(ElementsAre(0, 3, 2, 1), ElementsAre(1, 8, 5, 5)));
  EXPECT_THAT(node_set(mesh, "two faces").nodes, ElementsAre(0, 1, 2, 3, 5, 8));
  EXPECT_THAT(node_set(mesh, "edge").nodes, ElementsAre(0, 1));
  EXPECT_THAT(node_set(mesh, "pin").nodes, ElementsAre(8));
  EXPECT_THAT(node_set(mesh, "tip").nodes, ElementsAre(5, 6, 10, 11));
}

TEST(GmshFile, knows_the_line_of_a_cell) {
  const std::string text = small_gmsh_mesh({22, false, false, false});
  const FileMesh mesh = read_sound("a.msh", text);
  const std::size_t at = text.find("\n500 5 ");
  EXPECT_EQ(mesh.cell_places.at(0).line,
            std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 2);
  EXPECT_EQ(mesh.cell_places.at(0).column, 1);
}

TEST(GmshFile, without_physical_volumes_has_the_volumes_as_blocks) {
  const FileMesh mesh =
      read_sound("a.msh",
                 "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                 "5 1 1 1\n$EndNodes\n$Elements\n2\n1 4 2 0 12 1 2 3 4\n2 4 2 0 11 2 3 4 5\n$EndElements");
  ASSERT_THAT(mesh.blocks, SizeIs(2));
  EXPECT_EQ(mesh.blocks[0].name, "11");
  EXPECT_THAT(mesh.block("12")->cells, ElementsAre(0));
}

// ---- Abaqus ----------------------------------------------------------------------------------------------------

TEST(AbaqusFile, has_the_figures_of_an_independent_reader) {
  const std::map<std::string, std::map<std::string, std::string>> names = {
      {"Tensile.inp", {}}, {"jc_ti64_abq_builtin.inp", {{"cube", "Part-1-1.cube"}}}};
  for (const auto& [name, renamed] : names) {
    const FileMesh mesh = sample(name);
    const nlohmann::json figures = expected(name);
    EXPECT_THAT(mesh.points, SizeIs(figures.at("nodes")));
    EXPECT_THAT(mesh.cells, SizeIs(figures.at("cells").at("hexahedron")));
    for (const auto& [set, size] : figures.at("node_sets").items())
      EXPECT_THAT(node_set(mesh, renamed.contains(set) ? renamed.at(set) : set).nodes, SizeIs(size)) << set;
    ASSERT_THAT(mesh.blocks, SizeIs(1));
    EXPECT_NEAR(volume_of(mesh, mesh.blocks[0].cells), figures.at("volume"), 1e-9 * figures.at("volume").get<double>());
  }
  EXPECT_EQ(sample("Tensile.inp").blocks[0].name, "Square-1.ALL");
}

const std::string four_shapes =  // the same corners as of small_gmsh_mesh
    "*heading\n a mesh\n** a comment\n*NODE, nset=all nodes\n1,0,0,0\n2,1.,0,0\n 3, 1, 1, , "
    "\n4,0,1\n5,0,0,1\n6,1,0,1.D0\n"
    "7,1,1,1\n8,0,1,1\n9,2,0,.5\n10,2,1,5e-1\n11,.5,.5,2\n12,1.5,.5,3\n*Element, TYPE = c3d8r, elset=Brick\n"
    "100, 1,2,3,4,\n   5,6,7,8\n*ELEMENT,type=C3D6,\n  elset=wedge\n200,2,6,9,3,7,10\n*element,type=C3D5\n"
    "300,5,6,7,8,11\n*ELEMENT, TYPE=C3D4H, ELSET=tip\n400,6,7,11,12,\n*element, type=S4R, elset=sheet\n500,1,2,3,4\n"
    "*Element, type=MASS, elset=point\n501, 1\n*ELSET, ELSET=two\n wedge, 300\n";

TEST(AbaqusFile, of_all_shapes_has_blocks_sets_and_what_is_left_out) {
  const FileMesh mesh = read_sound("a.inp", four_shapes + "*solid section, elset=TWO, material=x\n1.,\n");
  const double volumes[] = {1.0, 0.5, 1.0 / 3.0, 1.0 / 4.0};
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(cell_volume(mesh, c), volumes[c], 1e-14) << c;
  ASSERT_THAT(mesh.blocks, SizeIs(3));
  EXPECT_THAT(mesh.block("two")->cells, ElementsAre(1, 2));
  EXPECT_THAT(mesh.block("Brick")->cells, ElementsAre(0));
  EXPECT_THAT(mesh.block("tip")->cells, ElementsAre(3));
  EXPECT_EQ(mesh.left_out, (std::map<std::string, std::int64_t>{{"MASS", 1}, {"S4R", 1}}));
  EXPECT_THAT(node_set(mesh, "all nodes").nodes, SizeIs(12));
  EXPECT_EQ(mesh.cell_places[0].line, 18);
}

TEST(AbaqusFile, elements_of_no_set_make_one_block) {
  const FileMesh mesh = read_sound("a.inp", "*NODE\n1,0,0\n2,1,0\n3,0,1\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1,2,3,4");
  ASSERT_THAT(mesh.blocks, SizeIs(1));
  EXPECT_EQ(mesh.blocks[0].name, "elements");
}

TEST(AbaqusFile, sets_take_labels_names_ranges_and_nodes_of_elements) {
  const FileMesh mesh = read_sound(
      "a.inp", four_shapes +
                   "*NSET, NSET=A, generate\n1,9,4\n*nset,nset=b\nA, 12,\n11\n*NSET, nset=tip nodes, elset=TIP\n"
                   "*NSET, nset=a\n2\n*elset,elset=most,GENERATE\n100,300,100\n*ELSET, elset=mixed\n100,500\n");
  EXPECT_THAT(node_set(mesh, "A").nodes, ElementsAre(0, 1, 4, 8));
  EXPECT_THAT(node_set(mesh, "b").nodes, ElementsAre(0, 4, 8, 10, 11));
  EXPECT_THAT(node_set(mesh, "tip nodes").nodes, ElementsAre(5, 6, 10, 11));
  std::map<std::string, std::vector<std::int32_t>> sets;
  for (const MeshBlock& set : mesh.cell_sets) sets[set.name] = set.cells;
  EXPECT_THAT(sets.at("most"), ElementsAre(0, 1, 2));
  EXPECT_THAT(sets.at("mixed"), ElementsAre(0));
}

TEST(AbaqusFile, faces_of_surfaces_look_outward) {
  std::string text = four_shapes;
  const std::pair<const char*, int> faces[] = {{"100", 6}, {"wedge", 5}, {"300", 5}, {"tip", 4}};
  for (const auto& [cells, n] : faces) {
    text += "*SURFACE, TYPE=ELEMENT, NAME=round " + std::string(cells) + "\n";
    for (int s = 1; s <= n; ++s) text += std::string(cells) + ", s" + std::to_string(s) + "\n";
  }
  const FileMesh mesh = read_sound("a.inp", text);
  for (std::int32_t c = 0; c < 4; ++c)
    EXPECT_NEAR(enclosed_by(mesh, face_set(mesh, "round " + std::string(faces[c].first))), cell_volume(mesh, c), 1e-14)
        << c;
}

TEST(AbaqusFile, instances_are_shifted_then_turned) {
  const FileMesh mesh = read_sound(
      "a.inp",
      "*PART, NAME=P\n*NODE\n1,0,0\n2,1,0\n3,0,1\n4,0,0,1\n*ELEMENT,TYPE=C3D4,ELSET=E\n7,1,2,3,4\n*NSET,NSET=N\n1,2\n"
      "*SOLID SECTION,ELSET=E\n*END PART\n*ASSEMBLY,NAME=A\n*INSTANCE,NAME=I,PART=p\n*END "
      "INSTANCE\n*INSTANCE,NAME=J,PART=P\n"
      "10,0,0\n10,0,0, 10,0,1, 90\n*END INSTANCE\n*NSET,NSET=both\ni.N, J.4\n*NSET,NSET=second,INSTANCE=J\n1,N\n"
      "*NODE\n99,5,5,5\n*NSET,NSET=reference\n99\n*END ASSEMBLY\n");
  ASSERT_THAT(mesh.points, SizeIs(9));
  EXPECT_TRUE(mesh.labels_repeat);
  EXPECT_THAT(mesh.points[4], ElementsAre(10, 0, 0));
  EXPECT_THAT(mesh.points[5], ElementsAre(10, 1, 0));
  EXPECT_THAT(mesh.points[6], ElementsAre(9, 0, 0));
  EXPECT_THAT(mesh.block("I.E")->cells, ElementsAre(0));
  EXPECT_THAT(mesh.block("J.E")->cells, ElementsAre(1));
  EXPECT_THAT(node_set(mesh, "J.N").nodes, ElementsAre(4, 5));
  EXPECT_THAT(node_set(mesh, "both").nodes, ElementsAre(0, 1, 7));
  EXPECT_THAT(node_set(mesh, "second").nodes, ElementsAre(4, 5));
  EXPECT_THAT(node_set(mesh, "reference").nodes, ElementsAre(8));
}

TEST(AbaqusFile, warns_where_a_range_has_numbers_that_do_not_exist) {
  Diagnostics diagnostics;
  read_abaqus({four_shapes + "*NSET, NSET=A, GENERATE\n1, 2000000000, 1\n", "a.inp"}, diagnostics);
  EXPECT_THAT(diagnostics.errors(), IsEmpty());
  EXPECT_THAT(diagnostics.warnings(),
              ElementsAre("a.inp:34:1: warning: set \"A\" has 2000000000 numbers, of which 1999999988 do not exist"));
}

// ---- Exodus ----------------------------------------------------------------------------------------------------

TEST(ExodusFile, has_the_figures_of_an_independent_reader) {
  for (const char* name : {"sphere_plate_contact.g", "cubes_contact.g", "wave_in_bar.g"}) {
    const FileMesh mesh = sample(name);
    const nlohmann::json figures = expected(name);
    EXPECT_EQ(mesh.format, "Exodus II, netCDF 64-bit offset");
    EXPECT_THAT(mesh.points, SizeIs(figures.at("nodes")));
    ASSERT_THAT(mesh.blocks, SizeIs(figures.at("blocks").size()));
    for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
      EXPECT_EQ(mesh.blocks[b].label, figures.at("blocks")[b].at("id"));
      expect_block(mesh, mesh.blocks[b], figures.at("blocks")[b]);
    }
    EXPECT_THAT(mesh.node_sets, SizeIs(figures.at("node_sets").size()));
    for (const auto& [set, size] : figures.at("node_sets").items())
      EXPECT_THAT(node_set(mesh, set).nodes, SizeIs(size)) << set;
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(box_of(mesh)[k], figures.at("box")[k].get<double>(), 1e-12);
  }
}

TEST(ExodusFile, of_all_shapes_is_the_same_in_every_format_of_netcdf) {
  const FileMesh first = sample("shapes_cdf1.exo");
  for (const char* name : {"shapes_cdf2.exo", "shapes_cdf5.exo", "shapes_nc4.exo"}) {
    const FileMesh mesh = sample(name);
    EXPECT_EQ(by_label(mesh), by_label(first)) << name;
    EXPECT_EQ(points_by_label(mesh), points_by_label(first)) << name;
    EXPECT_EQ(mesh.left_out, (std::map<std::string, std::int64_t>{{"SHELL4", 1}})) << name;
  }
}

TEST(ExodusFile, keeps_names_and_numbers_and_sides_look_outward) {
  const FileMesh mesh = sample("shapes_nc4.exo");
  EXPECT_THAT(mesh.cell_labels, ElementsAre(101, 202, 303, 404));
  EXPECT_EQ(mesh.node_labels.at(3), 1000 - 3 * 7);
  EXPECT_THAT(node_set(mesh, "bottom face").nodes, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(node_set(mesh, "9").nodes, IsEmpty());
  const double volumes[] = {1.0, 0.5, 1.0 / 3.0, 1.0 / 6.0};
  const char* names[] = {"brick", "ramp", "roof", "corner"};
  for (std::int32_t c = 0; c < 4; ++c) {
    EXPECT_THAT(mesh.block(names[c])->cells, ElementsAre(c));
    EXPECT_NEAR(cell_volume(mesh, c), volumes[c], 1e-14) << c;
    EXPECT_NEAR(enclosed_by(mesh, face_set(mesh, "around " + std::string(names[c]))), volumes[c], 1e-14) << c;
  }
  EXPECT_THAT(face_set(mesh, "around sheet").faces, IsEmpty());
}

// ---- What an input calls blocks and sets -----------------------------------------------------------------------

std::vector<std::int32_t> nodes_called(const MeshSets& sets, const std::string& name) {
  const int found = sets.find(name);
  if (found < 0) return {-1};
  return {sets.nodes(found).begin(), sets.nodes(found).end()};
}

TEST(MeshSets, have_a_plain_name_where_it_means_one_thing) {
  FileMesh mesh;
  mesh.node_sets = {{"low", 1, {0, 3}}, {"both", 2, {1, 2}}, {"alike", 3, {4, 5, 6}}, {"low", 4, {2, 3}}};
  mesh.face_sets = {{"both", 2, {{7, 5, 6, 6}}}, {"high", 3, {{9, 8, 7, 6}}}, {"alike", 5, {{6, 5, 4, 4}}}};
  mesh.face_sets.push_back({"high", 6, {{1, 9, 8, 8}}});
  const MeshSets sets(mesh);
  EXPECT_THAT(sets.names(), ElementsAre("alike", "face_set:alike", "face_set:both", "face_set:high", "high", "low",
                                        "node_set:alike", "node_set:both", "node_set:low"));
  EXPECT_THAT(nodes_called(sets, "both"), ElementsAre(-1));
  EXPECT_THAT(nodes_called(sets, "node_set:both"), ElementsAre(1, 2));
  EXPECT_THAT(nodes_called(sets, "face_set:both"), ElementsAre(5, 6, 7));
  EXPECT_THAT(nodes_called(sets, "alike"), ElementsAre(4, 5, 6));
  EXPECT_THAT(nodes_called(sets, "low"), ElementsAre(0, 2, 3));
  EXPECT_THAT(nodes_called(sets, "high"), ElementsAre(1, 6, 7, 8, 9));
  EXPECT_THAT(nodes_called(sets, "node_set:high"), ElementsAre(-1));
  EXPECT_EQ(sets.call(node_set_word, "both"), "node_set:both");
  EXPECT_EQ(sets.call(face_set_word, "both"), "face_set:both");
  EXPECT_EQ(sets.call(face_set_word, "alike"), "alike");
  EXPECT_EQ(sets.call(node_set_word, "low"), "low");
}

TEST(MeshSets, let_a_qualified_name_go_before_a_plain_one) {
  FileMesh mesh;
  mesh.node_sets = {{"a", 1, {0}}, {"face_set:a", 2, {1}}};
  mesh.face_sets = {{"a", 1, {{2, 3, 4, 5}}}};
  const MeshSets sets(mesh);
  EXPECT_THAT(nodes_called(sets, "face_set:a"), ElementsAre(2, 3, 4, 5));
  EXPECT_THAT(nodes_called(sets, "node_set:face_set:a"), ElementsAre(1));
  EXPECT_EQ(sets.call(node_set_word, "face_set:a"), "node_set:face_set:a");
}

TEST(MeshSets, of_a_surface_and_a_volume_of_one_name_are_two) {
  const FileMesh mesh = read_sound(
      "a.msh",
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"a\"\n3 2 \"a\"\n$EndPhysicalNames\n$Nodes\n4\n"
      "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n2\n1 2 2 1 1 1 2 3\n2 4 2 2 1 1 2 3 4\n$EndElements");
  const MeshSets sets(mesh);
  EXPECT_THAT(nodes_called(sets, "a"), ElementsAre(-1));
  EXPECT_THAT(nodes_called(sets, "face_set:a"), ElementsAre(0, 1, 2));
  EXPECT_THAT(nodes_called(sets, "node_set:a"), ElementsAre(0, 1, 2, 3));
}

TEST(MeshBlocks, of_one_name_are_called_by_their_numbers) {
  FileMesh mesh;
  mesh.blocks = {{"a", 3, {0}, {}}, {"b", 4, {1}, {}}, {"a", 5, {2}, {}}};
  EXPECT_EQ(mesh.block("a"), nullptr);
  EXPECT_EQ(mesh.block("block:5"), &mesh.blocks[2]);
  EXPECT_EQ(mesh.block("block:3"), &mesh.blocks[0]);
  EXPECT_EQ(mesh.block("b"), &mesh.blocks[1]);
  for (const char* name : {"block:6", "block:", "block:5 ", "5", ""}) EXPECT_EQ(mesh.block(name), nullptr) << name;
  EXPECT_EQ(mesh.call(mesh.blocks[2]), "block:5");
  EXPECT_EQ(mesh.call(mesh.blocks[1]), "b");
}

TEST(MeshFile, tells_what_is_left_out_once) {
  Diagnostics diagnostics;
  read_mesh({four_shapes, "a.inp"}, diagnostics);
  EXPECT_THAT(diagnostics.warnings(),
              ElementsAre("a.inp: warning: 2 elements that are no solids are left out, by kind: "
                          "1 \"MASS\", 1 \"S4R\""));
  Diagnostics of_gmsh;
  read_mesh({small_gmsh_mesh({22, false, false, false}), "a.msh"}, of_gmsh);
  EXPECT_THAT(of_gmsh.warnings(),
              ElementsAre("a.msh: warning: 1 element that is no solid is left out, by kind: 1 \"line\""));
}

}  // namespace
