#include "rivals.h"

#include <dlfcn.h>

#include <chrono>
#include <thread>

#include <suitesparse/cholmod.h>

#include "pvg/status.h"

namespace pvg::bench {

LinearSystem linear_system(const Domain& domain, const EnergyForm& form) {
    const int vertices = domain.surface.vertex_count(), channels = domain.channels;
    std::vector<int> follows(vertices, none);
    LinearSystem system;
    system.g = Eigen::MatrixXd::Zero(vertices, channels);
    for (const Coupling& c : domain.couplings)
        if (!domain.dirichlet[c.left] && c.left != c.right) {
            follows[c.left] = c.right;
            system.g.row(c.left) = c.jump;
        }
    std::vector<int> unknown(vertices, none);
    int count = 0;
    for (int v = 0; v < vertices; ++v) {
        if (domain.dirichlet[v])
            system.g.row(v) = domain.dirichlet_value.row(v);
        else if (follows[v] == none && domain.surface.outgoing(v) != none)
            unknown[v] = count++;
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (int v = 0; v < vertices; ++v) {
        const int right = follows[v];
        if (right != none && domain.dirichlet[right])
            system.g.row(v) += domain.dirichlet_value.row(right);
        else if (const int j = unknown[right == none ? v : right]; j != none)
            entries.emplace_back(v, j, 1.0);
    }
    system.P.resize(vertices, count);
    system.P.setFromTriplets(entries.begin(), entries.end());
    Eigen::MatrixXd load = form.S * system.g;
    for (int v = 0; v < vertices; ++v)
        for (int i = form.load_first[v]; i < form.load_first[v + 1]; ++i)
            load.row(v) += form.loads[i].second * domain.sources[form.loads[i].first].value;
    system.b = -(system.P.transpose() * load);
    system.A = system.P.transpose() * form.S * system.P;
    return system;
}

struct Cholmod::State {
    cholmod_common common{};
    cholmod_sparse A{};
    Eigen::SparseMatrix<double> lower;
    cholmod_factor* factor = nullptr;
    cholmod_dense *X = nullptr, *Y = nullptr, *E = nullptr;
};

Cholmod::Cholmod(const Eigen::SparseMatrix<double>& A) : state_(std::make_unique<State>()) {
    State& s = *state_;
    cholmod_start(&s.common);
    s.common.supernodal = CHOLMOD_SUPERNODAL;
    s.lower = A.triangularView<Eigen::Lower>();
    s.lower.makeCompressed();
    s.A.nrow = s.A.ncol = static_cast<std::size_t>(A.rows());
    s.A.nzmax = static_cast<std::size_t>(s.lower.nonZeros());
    s.A.p = s.lower.outerIndexPtr();
    s.A.i = s.lower.innerIndexPtr();
    s.A.x = s.lower.valuePtr();
    s.A.stype = -1;
    s.A.itype = CHOLMOD_INT;
    s.A.xtype = CHOLMOD_REAL;
    s.A.dtype = CHOLMOD_DOUBLE;
    s.A.sorted = s.A.packed = 1;
    refactor();
}

Cholmod::~Cholmod() {
    State& s = *state_;
    cholmod_free_factor(&s.factor, &s.common);
    for (cholmod_dense** dense : {&s.X, &s.Y, &s.E}) cholmod_free_dense(dense, &s.common);
    cholmod_finish(&s.common);
}

void Cholmod::refactor() {
    State& s = *state_;
    cholmod_free_factor(&s.factor, &s.common);
    s.factor = cholmod_analyze(&s.A, &s.common);
    if (!s.factor || !cholmod_factorize(&s.A, s.factor, &s.common) || s.common.status != CHOLMOD_OK)
        throw Error(ErrorKind::check_failed, "CHOLMOD did not factor the system, status " + std::to_string(s.common.status));
}

void Cholmod::solve(const Eigen::MatrixXd& b) {
    State& s = *state_;
    cholmod_dense B{};
    B.nrow = B.d = static_cast<std::size_t>(b.rows());
    B.ncol = static_cast<std::size_t>(b.cols());
    B.nzmax = static_cast<std::size_t>(b.size());
    B.x = const_cast<double*>(b.data());
    B.xtype = CHOLMOD_REAL;
    B.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_solve2(CHOLMOD_A, s.factor, &B, nullptr, &s.X, nullptr, &s.Y, &s.E, &s.common))
        throw Error(ErrorKind::check_failed, "CHOLMOD did not solve the system, status " + std::to_string(s.common.status));
}

Eigen::MatrixXd Cholmod::solution() const {
    const cholmod_dense& X = *state_->X;
    return Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(X.x), static_cast<Eigen::Index>(X.nrow),
                                             static_cast<Eigen::Index>(X.ncol));
}

std::string Cholmod::blas() {
    using Config = const char* (*)();
    const auto config = reinterpret_cast<Config>(dlsym(RTLD_DEFAULT, "openblas_get_config"));
    const auto core = reinterpret_cast<Config>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
    if (config && core)
        return std::string(config()) + ", running as " + core();
    return "not OpenBLAS";
}

double triad_bytes_per_second(int threads) {
    constexpr std::size_t n = std::size_t{1} << 24;  // 128 MiB an array: far beyond any cache
    std::vector<double> a(n), b(n), c(n);
    const auto run = [&](int thread) {
        const std::size_t begin = n * static_cast<std::size_t>(thread) / static_cast<std::size_t>(threads);
        const std::size_t end = n * static_cast<std::size_t>(thread + 1) / static_cast<std::size_t>(threads);
        for (std::size_t i = begin; i < end; ++i) a[i] = b[i] + 0.5 * c[i];
    };
    const auto all = [&] {
        std::vector<std::jthread> others;
        for (int t = 1; t < threads; ++t) others.emplace_back(run, t);
        run(0);
    };
    for (std::size_t i = 0; i < n; ++i) {
        b[i] = static_cast<double>(i & 7);
        c[i] = 1;
    }
    all();
    double best = 0;
    for (int repeat = 0; repeat < 5; ++repeat) {
        const auto started = std::chrono::steady_clock::now();
        all();
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
        best = std::max(best, 3.0 * n * sizeof(double) / seconds);
    }
    if (a[n / 2] != b[n / 2] + 0.5)
        throw Error(ErrorKind::check_failed, "the memory triad computed a wrong number");
    return best;
}

}  // namespace pvg::bench
