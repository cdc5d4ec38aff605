// Contact operator with virtual functions, for methods that are compiled once for all operators. These methods make few
// virtual calls per iteration; loops over the contacts are inside the operator.
#pragma once

#include "systems/solver/methods/conjugate_step.h"

namespace skerry {

/// Virtual versions of the functions of ContactOperator (operators/contact_operator.h).
class AnyOperator {
public:
    using Number = Real;

    virtual Index size() const = 0;
    virtual std::span<Vec4> impulse() = 0;
    virtual std::span<Vec4> workspace(Index slot) = 0;
    virtual void refresh() = 0;
    virtual void refresh_all() = 0;
    virtual void remember() = 0;
    virtual void extrapolate(Real factor) = 0;
    virtual Real sweep(Real relaxation) = 0;
    virtual SweepChange accelerated_sweep(Real relaxation) = 0;
    virtual Real error() = 0;
    virtual bool suggests_check(Real change, Real tolerance) = 0;
    virtual void residual(std::span<Vec4> out) = 0;
    virtual void multiply(std::span<const Vec4> in, std::span<Vec4> out) = 0;
    virtual Vec4 project(Index i, const Vec4& impulse) const = 0;
    virtual Vec4 feasible(Index i, const Vec4& residual) const = 0;
    virtual Vec4 normal(Index i) const = 0;
    virtual FrictionLimits limits(Index i) const = 0;
    virtual Real mobility(Index i) const = 0;
    virtual Friction law() const = 0;
    virtual void assemble(Eigen::MatrixXd& matrix) const = 0;
    /// Calls advance_conjugate_gradients.
    virtual ConjugateChange advance_gradients(ConjugateBeta formula) = 0;

protected:
    ~AnyOperator() = default;
};

static_assert(ContactOperator<AnyOperator>);

/// Adapter that forwards every call to the wrapped operator.
template <ContactOperator Op>
class OperatorView final : public AnyOperator {
public:
    explicit OperatorView(Op& op) : op_(op) {}

    Index size() const override { return op_.size(); }
    std::span<Vec4> impulse() override { return op_.impulse(); }
    std::span<Vec4> workspace(Index slot) override { return op_.workspace(slot); }
    void refresh() override { op_.refresh(); }
    void refresh_all() override { op_.refresh_all(); }
    void remember() override { op_.remember(); }
    void extrapolate(Real factor) override { op_.extrapolate(factor); }
    Real sweep(Real relaxation) override { return op_.sweep(relaxation); }
    SweepChange accelerated_sweep(Real relaxation) override { return op_.accelerated_sweep(relaxation); }
    Real error() override { return op_.error(); }
    bool suggests_check(Real change, Real tolerance) override { return op_.suggests_check(change, tolerance); }
    void residual(std::span<Vec4> out) override { op_.residual(out); }
    void multiply(std::span<const Vec4> in, std::span<Vec4> out) override { op_.multiply(in, out); }
    Vec4 project(Index i, const Vec4& impulse) const override { return op_.project(i, impulse); }
    Vec4 feasible(Index i, const Vec4& residual) const override { return op_.feasible(i, residual); }
    Vec4 normal(Index i) const override { return op_.normal(i); }
    FrictionLimits limits(Index i) const override { return op_.limits(i); }
    Real mobility(Index i) const override { return op_.mobility(i); }
    Friction law() const override { return op_.law(); }
    void assemble(Eigen::MatrixXd& matrix) const override { op_.assemble(matrix); }
    ConjugateChange advance_gradients(ConjugateBeta formula) override {
        return advance_conjugate_gradients(op_, formula);
    }

private:
    Op& op_;
};

}  // namespace skerry
