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

/* how far a layer gives way under a load [m], with the derivative [m/N] */
typedef struct pel_layer_state {
    double depth, slope;
} pel_layer_state;

/* The law of a layer that is `compliance` soft at first and stiffens as it is pressed together:

       load = (depth / compliance) / (1 - depth / thickness)

   up to a depth of PEL_LAYER_STRAIN of the thickness, and its tangent beyond, so that what is pressed on however far
   has a load. Both functions are inverse to each other. Without compliance there is no depth. */
#define PEL_LAYER_STRAIN 0.9
pel_layer_state pel_contact_layer_state(double compliance, double thickness, double load);
double pel_contact_layer_load(double compliance, double thickness, double depth);
/* J, that a load has stored in it: the integral of the load over the depth. */
double pel_contact_layer_energy(double compliance, double thickness, double load);

/* of the thickness: what is nearer to its layer is looked at in every substep */
#define PEL_CONTACT_NEAR_SHARE 0.1

#endif
