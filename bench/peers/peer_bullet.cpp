/* Marbles that fall into a box under Bullet (Debian's libbullet-dev), for tools/bodies-beside-peers, which compiles
   this with the numbers of the scene. Each line is a tenth of a second: kinetic energy [J], processor time of the steps
   since the line before [s], time [s], and all centers [m]. usage: peer_bullet sphere|hull SUBSTEPS FILE_OF_CENTERS */
#include <btBulletDynamicsCommon.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <vector>

namespace
{

/* Bullet's margins are made for sizes of about a meter, and its manual asks to scale smaller ones: decimetres */
const double SCALE = 10;

double seconds()
{
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* 162 points, as many as a geodesic sphere of 320 triangles has, spread by a spiral */
btCollisionShape *make_hull()
{
    btConvexHullShape *hull = new btConvexHullShape();
    for (int i = 0; i < 162; i++) {
        double z = 1 - (2 * i + 1) / 162.0, turn = i * M_PI * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
        hull->addPoint(btVector3(btScalar(SCALE * RADIUS * r * std::cos(turn)),
                                 btScalar(SCALE * RADIUS * r * std::sin(turn)), btScalar(SCALE * RADIUS * z)));
    }
    hull->setMargin(0);
    return hull;
}

void add_body(btDiscreteDynamicsWorld *world, btCollisionShape *shape, double mass, double x, double y, double z)
{
    btTransform place(btQuaternion::getIdentity(),
                      btVector3(btScalar(SCALE * x), btScalar(SCALE * y), btScalar(SCALE * z)));
    btVector3 inertia(0, 0, 0);
    if (mass > 0)
        shape->calculateLocalInertia(btScalar(mass), inertia);
    btRigidBody *body = new btRigidBody(
        btRigidBody::btRigidBodyConstructionInfo(btScalar(mass), new btDefaultMotionState(place), shape, inertia));
    body->setFriction(btScalar(std::sqrt(FRICTION)));
    world->addRigidBody(body);
}

void add_walls(btDiscreteDynamicsWorld *world)
{
    const double normals[5][3] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    const double offsets[5] = {0, -HALF_X, -HALF_X, -HALF_Y, -HALF_Y};
    for (int i = 0; i < 5; i++)
        add_body(
            world,
            new btStaticPlaneShape(btVector3(btScalar(normals[i][0]), btScalar(normals[i][1]), btScalar(normals[i][2])),
                                   btScalar(SCALE * offsets[i])),
            0, 0, 0, 0);
}

void tell(const btDiscreteDynamicsWorld *world, int first, double mass, double spent, double time)
{
    double energy = 0;
    for (int i = first; i < world->getNumCollisionObjects(); i++) {
        const btRigidBody *body = btRigidBody::upcast(world->getCollisionObjectArray()[i]);
        energy += 0.5 * mass * body->getLinearVelocity().length2() / (SCALE * SCALE);
        energy += 0.5 * 0.4 * mass * RADIUS * RADIUS * body->getAngularVelocity().length2();
    }
    std::printf("%.6g %.6g %.6g", energy, spent, time);
    for (int i = first; i < world->getNumCollisionObjects(); i++) {
        const btVector3 &x = world->getCollisionObjectArray()[i]->getWorldTransform().getOrigin();
        std::printf(" %.9g %.9g %.9g", x.x() / SCALE, x.y() / SCALE, x.z() / SCALE);
    }
    std::printf("\n");
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
    world.setGravity(btVector3(0, 0, btScalar(-9.81 * SCALE)));
    add_walls(&world);
    int walls = world.getNumCollisionObjects(), substeps = std::atoi(argv[2]);
    btCollisionShape *shape =
        std::strcmp(argv[1], "hull") == 0 ? make_hull() : new btSphereShape(btScalar(SCALE * RADIUS));
    double mass = DENSITY * 4 / 3 * M_PI * RADIUS * RADIUS * RADIUS, x, y, z, spent = 0;
    std::ifstream centers(argv[3]);
    while (centers >> x >> y >> z)
        add_body(&world, shape, mass, x, y, z);
    for (int step = 1; step <= std::lround(60 * SECONDS); step++) {
        double begin = seconds();
        world.stepSimulation(btScalar(1.0 / 60), substeps, btScalar(1.0 / 60 / substeps));
        spent += seconds() - begin;
        if (step % 6 != 0)
            continue;
        tell(&world, walls, mass, spent, step / 60.0);
        spent = 0;
    }
    return 0;
}
