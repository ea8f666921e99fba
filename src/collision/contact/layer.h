/* The compliant layer that a pair of surfaces, or a surface and a tool, keeps between them. */
#ifndef PEL_CONTACT_LAYER_H
#define PEL_CONTACT_LAYER_H

/* s, in which a pair that started at no distance comes to keep the whole thickness */
#define PEL_CONTACT_RECOVERY_TIME 0.2

/* of a body */
typedef struct pel_contact_layer {
    double thickness; /* m, above 0 */
    double hardness;  /* N/(m kg): E A / l over the mass of the area A, where what gives way is l thick; 0 = unknown */
} pel_contact_layer;

/* Compliance [m/N] of the layer before a mass [kg] of a body: l / (E A), or less if an approach with
   this speed [m/s] has to stop within half of the thickness. A body without a modulus has a layer that gravity does not
   press in in steps of dt [s]. */
double pel_contact_layer_compliance(const pel_contact_layer *layer, double mass, double speed, double dt);

/* of the thickness: what is nearer to its layer is looked at in every substep */
#define PEL_CONTACT_NEAR_SHARE 0.1

#endif
