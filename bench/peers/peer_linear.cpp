#include "peer_linear.h"

#include <Eigen/CholmodSupport>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include <algorithm>

namespace
{

using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

/* lower triangle */
Sparse lower_of(const pel_matrix *m)
{
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < m->node_count; i++)
        for (int block = m->row_start[i]; block < m->row_start[i + 1]; block++) {
            int row = m->first_unknown[i], rows = m->first_unknown[i + 1] - row;
            int column = m->first_unknown[m->column[block]];
            int columns = m->first_unknown[m->column[block] + 1] - column;
            for (int b = 0; b < columns; b++)
                for (int a = 0; a < rows; a++)
                    if (row + a >= column + b)
                        entries.emplace_back(row + a, column + b, m->values[m->block_start[block] + a + rows * b]);
        }
    Sparse lower(m->unknown_count, m->unknown_count);
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
}

template <class Solver>
peer_times time_of(const char *name, const Sparse &lower, const double *right, double (*seconds)(), int repeats)
{
    peer_times times = {name, 0, 1e9, 1e9, 0};
    Eigen::Map<const Vector> b(right, lower.rows());
    Solver solver;
    double begin = seconds();
    solver.analyzePattern(lower);
    times.analyze = seconds() - begin;
    Vector x;
    for (int i = 0; i < repeats; i++) {
        begin = seconds();
        solver.factorize(lower);
        double middle = seconds();
        x = solver.solve(b);
        times.factor = std::min(times.factor, middle - begin);
        times.solve = std::min(times.solve, seconds() - middle);
    }
    times.residual = (b - lower.selfadjointView<Eigen::Lower>() * x).norm() / b.norm();
    return times;
}

} // namespace

int peer_linear(const pel_matrix *matrix, const double *right, double (*seconds)(void), int repeats,
                peer_times times[4])
{
    const Sparse lower = lower_of(matrix);
    times[0] = time_of<Eigen::SimplicialLLT<Sparse>>("Eigen SimplicialLLT", lower, right, seconds, repeats);
    times[1] = time_of<Eigen::SimplicialLDLT<Sparse>>("Eigen SimplicialLDLT", lower, right, seconds, repeats);
    times[2] = time_of<Eigen::CholmodSupernodalLLT<Sparse>>("CHOLMOD supernodal", lower, right, seconds, repeats);
    return 3;
}
