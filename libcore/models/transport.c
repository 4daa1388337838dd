/* The laws of viscosity and heat conduction, each with its parameters and its row of the table (transport.h). */
#include "libcore/models/transport.h"

#include "libcore/models/kernel.h"

#define PI 3.14159265358979323846

struct jenkins_richman { /* the law's own parameters */
    double alpha_min;    /* packing fraction below which G no longer falls in the coefficients */
    int bulk;            /* index of bulk_words; 1: the bulk viscosity is twice as large, as printed (erratum C2) */
};
OWN_PARAMS_FIT(struct jenkins_richman);

/* Jenkins & Richman (1985) as in Carrillo, Poeschel & Saluena (2.12)-(2.14):
 *   bulk = 2/sqrt pi rho sigma sqrt T G,  shear = sqrt pi/8 rho sigma sqrt T [1/G + 2 + (1 + 8/pi) G],
 *   heat = sqrt pi/2 rho sigma sqrt T [1/G + 3 + (9/4 + 4/pi) G].
 * Where G vanishes, rho/G has a limit, but diffusivities, which are coefficients per rho, have none: below alpha_min G
 * is taken at alpha_min. Near packing G is taken at most where the equation of state begins its tangent. The factor rho
 * itself is never clipped. */
KERNEL static void disks_of_contact(int n, double sigma, double bulk_factor, const double *restrict rho,
                                    const double *restrict T, const double *restrict contact, double *restrict bulk,
                                    double *restrict shear, double *restrict heat) {
    const double root_pi = sqrt(PI), b = 2 / root_pi * bulk_factor;
    for (int i = 0; i < n; i++) {
        double G = contact[i], inverse = 1 / G, factor = rho[i] * sigma * sqrt(T[i]);
        bulk[i] = b * factor * G;
        shear[i] = root_pi / 8 * factor * (inverse + 2 + (1 + 8 / PI) * G);
        heat[i] = root_pi / 2 * factor * (inverse + 3 + (9. / 4 + 4 / PI) * G);
    }
}

static void jenkins_richman(const struct own_params *params, const struct eos *eos, const struct material *m, int n,
                            const double *restrict rho, const double *restrict T, double *restrict bulk,
                            double *restrict shear, double *restrict heat) {
    struct jenkins_richman own;
    memcpy(&own, params, sizeof own);
    const double per = packing_per_density(m), low = own.alpha_min / per, high = EOS_PACKING * m->alpha_max / per;
    double clipped[BATCH], contact[BATCH];
    for (int i = 0; i < n; i++) clipped[i] = smaller(larger(rho[i], low), high);
    eos->contact(m, n, clipped, contact);
    disks_of_contact(n, m->diameter, own.bulk ? 2 : 1, rho, T, contact, bulk, shear, heat);
}

#define PARAM_STRUCT struct jenkins_richman
static const char *const bulk_words[] = {"corrected", "paper", NULL};
static const struct param jenkins_richman_param[] = {
    NUMBER("alphaMin", alpha_min, 1e-4, BETWEEN(0, 1), NO_UNIT,
           "packing fraction below which viscosity and conductivity fall with the density"),
    CHOICE("bulk", bulk, 0, bulk_words, "viscosity by the contact integral, or twice that, as printed"),
};

const struct transport transport_table[] = {
    {MODEL_WITH("JenkinsRichman", "viscosities and heat conductivity of dense disks (Jenkins & Richman 1985)",
                jenkins_richman_param),
     .valid = GRAINS_DISKS, .coefficients = jenkins_richman},
};
const int transport_count = sizeof transport_table / sizeof *transport_table;

const struct transport *transport_find(const char *name) {
    return model_find(transport_table, sizeof *transport_table, transport_count, name);
}
