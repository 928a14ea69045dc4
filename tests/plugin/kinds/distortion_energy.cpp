// An erosion criterion outside of Kerf's tree: the elastic energy of distortion, after Huber.
//
// Source: M.T. Huber, "Wlasciwa praca odksztalcenia jako miara wytezenia materyalu", Czasopismo Techniczne 22 (1904).
#include <kerf/erosion.hpp>

/// Fails a point where q^2 / (6 G) reaches the limit.
struct DistortionEnergy final : kerf::PointwiseErosion<DistortionEnergy> {
  double G = 0.0, limit = 0.0;  // [Pa], [J/m3]
  using State = kerf::NoVariables;
  using Reads = kerf::NoVariables;

  static void describe(kerf::Schema<DistortionEnergy>& s) {
    s.real(&DistortionEnergy::G, "shear_modulus", "Pa", kerf::positive, "elastic shear modulus");
    s.real(&DistortionEnergy::limit, "limit", "J/m3", kerf::positive, "elastic energy of distortion at failure");
    describe_interval(s);
  }
  kerf::Verdict judge_point(const kerf::ErosionInputPoint& in, const Reads&, State&) const {
    const double q = von_mises(deviator(in.stress)), energy = q * q / (6.0 * G);
    return {energy, kerf::select(energy >= limit, 1.0, 0.0)};
  }
};

KERF_EROSION(DistortionEnergy, "distortion_energy", "elastic energy of distortion reaches a limit")
