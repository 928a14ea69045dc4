// How long a mesh of a million hexahedra takes to read as text: a file of Gmsh 2.2, one of Gmsh 4.1, a deck of Abaqus.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

#include "mesh/mesh_file.hpp"

namespace {

constexpr int n = 100, m = n + 1;  // cells and nodes along an edge

long node(int i, int j, int k) { return 1 + i + static_cast<long>(m) * (j + static_cast<long>(m) * k); }

void write_nodes(std::FILE* out, const char* format) {
  for (int k = 0; k < m; ++k)
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) std::fprintf(out, format, node(i, j, k), i / 3.0, j / 7.0, k / 9.0);
}

void write_cells(std::FILE* out, const char* before, const char* between) {
  long e = 0;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        std::fprintf(out, "%ld%s", ++e, before);
        for (const int z : {k, k + 1})
          for (const long label : {node(i, j, z), node(i + 1, j, z), node(i + 1, j + 1, z), node(i, j + 1, z)})
            std::fprintf(out, "%s%ld", between, label);
        std::fputc('\n', out);
      }
}

void write_gmsh_22(std::FILE* out) {
  std::fprintf(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n", m * m * m);
  write_nodes(out, "%ld %.16g %.16g %.16g\n");
  std::fprintf(out, "$EndNodes\n$Elements\n%d\n", n * n * n);
  write_cells(out, " 5 2 1 1", " ");
  std::fputs("$EndElements\n", out);
}

void write_gmsh_41(std::FILE* out) {
  std::fprintf(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 %d 1 %d\n3 1 0 %d\n", m * m * m, m * m * m,
               m * m * m);
  for (int i = 1; i <= m * m * m; ++i) std::fprintf(out, "%d\n", i);
  for (int k = 0; k < m; ++k)
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) std::fprintf(out, "%.16g %.16g %.16g\n", i / 3.0, j / 7.0, k / 9.0);
  std::fprintf(out, "$EndNodes\n$Elements\n1 %d 1 %d\n3 1 5 %d\n", n * n * n, n * n * n, n * n * n);
  write_cells(out, "", " ");
  std::fputs("$EndElements\n", out);
}

void write_abaqus(std::FILE* out) {
  std::fputs("*NODE\n", out);
  write_nodes(out, "%ld, %.16g, %.16g, %.16g\n");
  std::fputs("*ELEMENT, TYPE=C3D8R, ELSET=all\n", out);
  write_cells(out, "", ", ");
}

void read(benchmark::State& state, const std::string& name, const std::function<void(std::FILE*)>& write) {
  const std::string path = (std::filesystem::temp_directory_path() / name).string();
  std::FILE* out = std::fopen(path.c_str(), "w");
  if (!out) return state.SkipWithError("the file cannot be written");
  write(out);
  std::fclose(out);
  for (auto _ : state) {
    kerf::Diagnostics diagnostics;
    const kerf::FileMesh mesh = kerf::read_mesh_file(path, diagnostics);
    if (diagnostics.has_errors() || mesh.cells.size() != static_cast<std::size_t>(n) * n * n)
      state.SkipWithError("the mesh is not what was written");
  }
  state.counters["MB"] = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  std::filesystem::remove(path);
}

BENCHMARK_CAPTURE(read, gmsh_22, "kerf_million_22.msh", write_gmsh_22)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK_CAPTURE(read, gmsh_41, "kerf_million_41.msh", write_gmsh_41)->Unit(benchmark::kMillisecond)->Iterations(3);
BENCHMARK_CAPTURE(read, abaqus, "kerf_million.inp", write_abaqus)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
