#include "OsteonGuidanceComponent.h"

#include "OsteonConvert.h"
#include "OsteonRefusal.h"

void UOsteonGuidanceComponent::BeginPlay() {
  USceneComponent::BeginPlay();
  Open();
}

void UOsteonGuidanceComponent::EndPlay(const EEndPlayReason::Type Reason) {
  Close();
  USceneComponent::EndPlay(Reason);
}

bool UOsteonGuidanceComponent::Open() {
  Close();
  const FTCHARToUTF8 PlanText(*Plan), FolderText(*ConfigFolder);
  osteon::host::PlanParams Params;
  Params.plan = PlanText.Get();
  Params.config_folder = ConfigFolder.IsEmpty() ? nullptr : FolderText.Get();
  OsteonGuidanceParams GuidanceParams;
  if (!Succeeds(HostPlan.Open(Params)) || !Succeeds(HostPlan.GetInfo(&Info)) ||
      !Succeeds(osteon_guidance_params_init(OSTEON_ABI, &GuidanceParams)))
    return false;
  GuidanceParams.reamer = static_cast<uint32>(Reamer);  // a negative index is out of range as well
  GuidanceParams.gain = Gain;
  GuidanceParams.max_force_N = MaxForce_N;
  return Succeeds(HostGuidance.Open(HostPlan, GuidanceParams));
}

void UOsteonGuidanceComponent::Close() {
  HostGuidance.Close();
  HostPlan.Close();
  Info = {};
  Last = {};
  LastRefusal.Empty();
}

bool UOsteonGuidanceComponent::Evaluate(const FTransform& Pose, const FVector& Velocity,
                                        const FVector& AngularVelocity, const FVector& OtherForce_N,
                                        const FVector& OtherTorque_Nm, FVector& Force_N, FVector& Torque_Nm) {
  osteon::host::Guided Guided{};
  const bool bGood = Succeeds(
      HostGuidance.Evaluate(OsteonConvert::ToPose(Pose), OsteonConvert::ToTwist(Velocity, AngularVelocity),
                            OsteonConvert::ToWrench(OtherForce_N, OtherTorque_Nm), &Guided));
  Last = Guided.values;
  Force_N = OsteonConvert::ToVector(Guided.wrench.force_N);
  Torque_Nm = OsteonConvert::ToVector(Guided.wrench.torque_Nm);
  return bGood;
}

bool UOsteonGuidanceComponent::SetGain(double NewGain) { return Succeeds(HostGuidance.SetGain(NewGain)); }

bool UOsteonGuidanceComponent::SetModelAge(double Age_s) { return Succeeds(HostGuidance.SetModelAge(Age_s)); }

bool UOsteonGuidanceComponent::Reset() { return Succeeds(HostGuidance.Reset()); }

FVector UOsteonGuidanceComponent::GetCupAxis() const { return OsteonConvert::ToVector(Info.cup_axis); }

FVector UOsteonGuidanceComponent::GetCupCenter() const { return OsteonConvert::ToVector(Info.cup_center); }

bool UOsteonGuidanceComponent::GetReamer(int32 Index, FVector& Apex, double& Diameter_mm) {
  osteon::host::Reamer Found;
  const bool bGood = Succeeds(HostPlan.GetReamer(static_cast<uint32>(Index), &Found));
  Apex = OsteonConvert::ToVector(Found.apex);
  Diameter_mm = 1e3 * Found.diameter_m;
  return bGood;
}

bool UOsteonGuidanceComponent::Succeeds(OsteonResult Result) {
  return OsteonSucceeds(Result, LastRefusal, OnRefused);
}
