/*
 * The simulator in C: arrays of doubles in, arrays of doubles out, nothing thrown.
 *
 * For what knows neither C++ nor Python: `make wasm` compiles it to WebAssembly, for a page that
 * simulates without a server.  Energies and kT are in meV, fields in T and along the wire,
 * conductances in e²/h.  The last axis of an array varies fastest.
 *
 * A grid is `wires` wires of `sites` sites each, at all pairs of mu_count chemical potentials and
 * B_count fields:
 *
 *     V           (wire, site), with the barriers
 *     parameters  (wire, NANOWIRE_PARAMETERS): t, α/2a, ½gμ_B, γ, Δ₀; of the leads µ, α/2a and
 *                 ½gμ_B; dissipation of the wire and of its parent
 *
 * which is what `handed_over` of solver/compiled.py returns.  Conductances come in the order G_LL,
 * G_RR, G_LR, G_RL.
 *
 * Each function returns how it went, one of nanowire_status.  Where memory ends there is nothing to
 * return: the program ends, in WebAssembly by a trap.
 */
#ifndef NANOWIRE_C_INTERFACE_H
#define NANOWIRE_C_INTERFACE_H

#ifdef __cplusplus
#define NANOWIRE_API extern "C" __attribute__((visibility("default")))
#define NANOWIRE_NOEXCEPT noexcept
#else
#define NANOWIRE_API extern
#define NANOWIRE_NOEXCEPT
#endif

enum { NANOWIRE_PARAMETERS = 10 };

enum nanowire_status {
    NANOWIRE_DONE = 0,
    /* All is written, but some of it is no number, or less exact than the tolerance. */
    NANOWIRE_INEXACT = 1,
    /* Nothing is written: no wire, point, energy or bias, or fewer than two sites; */
    NANOWIRE_BAD_COUNT = 2,
    /* … a number that goes in is none, or infinite; */
    NANOWIRE_NOT_FINITE = 3,
    /* … t ≤ 0, Δ₀ ≤ 0, γ < 0 or dissipation < 0, or dissipation where there may
     * be none, or none other than the parent's; */
    NANOWIRE_BAD_WIRE = 4,
    /* … kT ≤ 0; */
    NANOWIRE_BAD_TEMPERATURE = 5,
    /* … a bias that is not below the gap. */
    NANOWIRE_BAD_BIAS = 6
};

/* Room for so many doubles, to be given back by nanowire_free; NULL where there is none. */
NANOWIRE_API double* nanowire_allocate(int count) NANOWIRE_NOEXCEPT;
NANOWIRE_API void nanowire_free(double* room) NANOWIRE_NOEXCEPT;

/*
 * The conductances at T = 0 and at energies ±omega of any size but Δ₀.
 *
 *     G  (wire, mu, B, omega, 2, 4), the axis of two being the sign of the energy
 */
NANOWIRE_API int nanowire_conductance(int wires, int sites, const double* V,
                                      const double* parameters, int mu_count, const double* mu,
                                      int B_count, const double* B, int omega_count,
                                      const double* omega, double* G) NANOWIRE_NOEXCEPT;

/*
 * Their thermal averages, of wires that are as dissipative as their parents.
 *
 *     G      (wire, mu, B, bias, 4)
 *     error  (wire, mu, B), estimated, of the worst of a point; infinite where none was found
 *
 * Each |bias| must be below the gap.  Work is added until the error is no more than
 * the tolerance, for which Python takes 1e-4, or for NANOWIRE_INEXACT.
 */
NANOWIRE_API int nanowire_thermal_conductance(int wires, int sites, const double* V,
                                              const double* parameters, int mu_count,
                                              const double* mu, int B_count, const double* B,
                                              int bias_count, const double* bias, double kT,
                                              double tolerance, double* G,
                                              double* error) NANOWIRE_NOEXCEPT;

/*
 * det r at zero energy of both ends, of wires without dissipation.
 *
 *     det_r  (wire, 2, mu, B), left, then right
 */
NANOWIRE_API int nanowire_reflection_determinant(int wires, int sites, const double* V,
                                                 const double* parameters, int mu_count,
                                                 const double* mu, int B_count, const double* B,
                                                 double* det_r) NANOWIRE_NOEXCEPT;

#endif
