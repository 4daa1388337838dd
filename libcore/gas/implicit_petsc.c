/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The module of implicit.h: PETSc's conjugate gradients and residuals. It shares no symbol with haff. */
#include "libcore/gas/implicit.h"

#include <petscksp.h>

enum { MOST_ITERATIONS = 400 };
#define LEAST_PIVOT 1e-300 /* kg */

struct linear_solver {
    const struct linear_system *system;
    Mat A, P;
    Vec b, x;
    KSP ksp;
    PC inner;     /* the preconditioner; KSP sees a shell around it that also notes the residual */
    Vec residual; /* KSP's residual at the last preconditioning */
};

extern const struct linear_module haff_linear_module;

static PetscErrorCode multiply(Mat A, Vec x, Vec y) {
    const struct linear_solver *l;
    const double *from;
    double *to;
    PetscCall(MatShellGetContext(A, (void *)&l));
    PetscCall(VecGetArrayRead(x, &from));
    PetscCall(VecGetArrayWrite(y, &to));
    l->system->apply(l->system->caller, from, to);
    PetscCall(VecRestoreArrayRead(x, &from));
    PetscCall(VecRestoreArrayWrite(y, &to));
    return 0;
}

static PetscErrorCode precondition(PC pc, Vec r, Vec z) {
    struct linear_solver *l;
    PetscCall(PCShellGetContext(pc, (void *)&l));
    l->residual = r;
    PetscCall(PCApply(l->inner, r, z));
    return 0;
}

/* Computes the error of the present solution. Conjugate gradients and residuals both keep one residual, which
 * l->residual shows in its newest state; before the first iteration it is b. */
static PetscErrorCode find_error(const struct linear_solver *l, PetscInt iteration, double *error) {
    const double *x, *residual;
    const Vec r = iteration > 0 ? l->residual : l->b;
    PetscCall(VecGetArrayRead(l->x, &x));
    PetscCall(VecGetArrayRead(r, &residual));
    *error = l->system->error(l->system->caller, x, residual);
    PetscCall(VecRestoreArrayRead(l->x, &x));
    PetscCall(VecRestoreArrayRead(r, &residual));
    return 0;
}

static PetscErrorCode enough(KSP ksp, PetscInt iteration, PetscReal norm, KSPConvergedReason *reason, void *context) {
    double error = PETSC_INFINITY;
    (void)ksp;
    PetscCall(find_error(context, iteration, &error));
    *reason = error <= 1                     ? KSP_CONVERGED_ATOL
              : PetscIsInfOrNanReal(norm)    ? KSP_DIVERGED_NANORINF
              : iteration >= MOST_ITERATIONS ? KSP_DIVERGED_ITS
                                             : KSP_CONVERGED_ITERATING;
    return 0;
}

/* ---- PETSc as a whole ---- */

static int finish(MPI_Comm comm, int key, void *value, void *extra) {
    (void)comm, (void)key, (void)value, (void)extra;
    return PetscFinalize() ? MPI_ERR_OTHER : MPI_SUCCESS;
}

/* Starts PETSc once in a program. MPI_Finalize begins with the attributes of MPI_COMM_SELF, so `finish` ends PETSc in
 * time. */
static PetscErrorCode start(MPI_Comm comm) {
    PetscBool started;
    int key;
    PetscCall(PetscInitialized(&started));
    if (started) return 0;
    PETSC_COMM_WORLD = comm;
    PetscCall(PetscOptionsSetValue(NULL, "-skip_petscrc", "true"));
    PetscCall(PetscOptionsSetValue(NULL, "-no_signal_handler", "true"));
    PetscCall(PetscInitializeNoArguments());
    PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, finish, &key, NULL);
    MPI_Comm_set_attr(MPI_COMM_SELF, key, NULL);
    return 0;
}

static const char *text_of(PetscErrorCode code) {
    const char *text = NULL;
    if (code) PetscErrorMessage(code, &text, NULL);
    return code && !text ? "an error without a text" : text;
}

/* ---- what the module exports ---- */

static PetscErrorCode make_matrices(struct linear_solver *l, MPI_Comm comm) {
    const struct linear_system *s = l->system;
    int size;
    MPI_Comm_size(comm, &size);
    PetscCall(MatCreateShell(comm, s->rows, s->rows, PETSC_DETERMINE, PETSC_DETERMINE, l, &l->A));
    PetscCall(MatShellSetOperation(l->A, MATOP_MULT, (void (*)(void))multiply));
    if (size == 1)
        PetscCall(MatCreateSeqAIJWithArrays(comm, s->rows, s->rows, s->first, s->column, s->value, &l->P));
    else
        PetscCall(MatCreateMPIAIJWithArrays(comm, s->rows, s->rows, PETSC_DETERMINE, PETSC_DETERMINE, s->first,
                                            s->column, s->value, &l->P));
    PetscCall(MatSetOption(l->P, MAT_SYMMETRIC, PETSC_TRUE));
    PetscCall(MatSetOption(l->P, MAT_SPD, PETSC_TRUE));
    PetscCall(VecCreateMPIWithArray(comm, 1, s->rows, PETSC_DETERMINE, NULL, &l->b));
    PetscCall(VecCreateMPIWithArray(comm, 1, s->rows, PETSC_DETERMINE, NULL, &l->x));
    return 0;
}

static PetscErrorCode make_ksp(struct linear_solver *l, MPI_Comm comm) {
    PC pc;
    PetscCall(KSPCreate(comm, &l->ksp));
    PetscCall(KSPSetOperators(l->ksp, l->A, l->P));
    PetscCall(KSPSetType(l->ksp, l->system->symmetric ? KSPCG : KSPGCR));
    PetscCall(KSPSetNormType(l->ksp, KSP_NORM_UNPRECONDITIONED));
    PetscCall(KSPSetConvergenceTest(l->ksp, enough, l, NULL));
    PetscCall(KSPGetPC(l->ksp, &pc));
    PetscCall(PCSetType(pc, PCSHELL));
    PetscCall(PCShellSetContext(pc, l));
    PetscCall(PCShellSetApply(pc, precondition));
    PetscCall(PCCreate(comm, &l->inner));
    PetscCall(PCSetOperators(l->inner, l->P, l->P));
    PetscCall(PCSetType(l->inner, PCBJACOBI));
    return 0;
}

static const char *module_make(const struct linear_system *s, struct linear_solver **out) {
    const MPI_Comm comm = *(MPI_Comm *)s->comm;
    PetscErrorCode code = start(comm);
    *out = NULL;
    if (!code) code = PetscNew(out);
    if (code) return text_of(code);
    (*out)->system = s;
    code = make_matrices(*out, comm);
    if (!code) code = make_ksp(*out, comm);
    return text_of(code);
}

/* Factors this rank's block by ILU(1), on a symmetric matrix the same as incomplete Cholesky: it takes two thirds of
 * the iterations of ILU(0). The factors are computed when they are first applied. PETSc adds 2e-14 to pivots below that
 * number, by default; here pivots are masses of cells, in kg, which may be far smaller. */
static PetscErrorCode factor(PC blocks) {
    KSP *block;
    PC pc;
    PetscCall(PCBJacobiGetSubKSP(blocks, NULL, NULL, &block));
    PetscCall(KSPGetPC(block[0], &pc));
    PetscCall(PCSetType(pc, PCILU));
    PetscCall(PCFactorSetLevels(pc, 1));
    PetscCall(PCFactorSetShiftType(pc, MAT_SHIFT_NONE));
    PetscCall(PCFactorSetZeroPivot(pc, LEAST_PIVOT));
    return 0;
}

static PetscErrorCode prepare(struct linear_solver *l) {
    PetscMPIInt size;
    MPI_Comm_size(PetscObjectComm((PetscObject)l->P), &size);
    if (size > 1) {
        PetscCall(MatUpdateMPIAIJWithArray(l->P, l->system->value));
    } else { /* the matrix works on the array itself: this tells it that the values changed */
        double *value;
        PetscCall(MatSeqAIJGetArray(l->P, &value));
        PetscCall(MatSeqAIJRestoreArray(l->P, &value));
    }
    PetscCall(PCSetUp(l->inner));
    return factor(l->inner);
}

static const char *module_prepare(struct linear_solver *l) {
    return text_of(prepare(l));
}

static PetscErrorCode solve(struct linear_solver *l, const double *b, double *x, int *iterations) {
    KSPConvergedReason reason;
    PetscCall(VecPlaceArray(l->b, b));
    PetscCall(VecPlaceArray(l->x, x));
    PetscCall(KSPSolve(l->ksp, l->b, l->x));
    PetscCall(VecResetArray(l->b));
    PetscCall(VecResetArray(l->x));
    PetscCall(KSPGetIterationNumber(l->ksp, iterations));
    PetscCall(KSPGetConvergedReason(l->ksp, &reason));
    if (reason < 0) *iterations = -1;
    return 0;
}

static const char *module_solve(struct linear_solver *l, const double *b, double *x, int *iterations) {
    return text_of(solve(l, b, x, iterations));
}

static void module_free(struct linear_solver *l) {
    if (!l) return;
    (void)KSPDestroy(&l->ksp);
    (void)PCDestroy(&l->inner);
    (void)MatDestroy(&l->A);
    (void)MatDestroy(&l->P);
    (void)VecDestroy(&l->b);
    (void)VecDestroy(&l->x);
    (void)PetscFree(l);
}

const struct linear_module haff_linear_module = {module_make, module_prepare, module_solve, module_free};
