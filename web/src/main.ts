import "./style.css";
import { Campaign, type CampaignJson } from "./campaign";
import { showCampaign } from "./campaign_page";
import { showComparison } from "./comparison_page";
import { el } from "./dom";
import { showLive } from "./live_page";
import { Run, type RunJson } from "./run";
import { showRun } from "./run_page";

type PageData =
  { kind: "runs"; runs: RunJson[] } | { kind: "campaign"; campaign: CampaignJson } | { kind: "live"; run: RunJson };

async function show(root: HTMLElement, data: PageData): Promise<void> {
  if (data.kind === "campaign") {
    showCampaign(root, await Campaign.load(data.campaign));
    return;
  }
  if (data.kind === "live") {
    showLive(root, Run.live(data.run));
    return;
  }
  const runs = await Promise.all(data.runs.map((json) => Run.load(json)));
  if (runs.length === 1) showRun(root, runs[0]);
  else showComparison(root, runs);
}

const root = document.getElementById("page");
const text = document.getElementById("data")?.textContent ?? "";
if (root !== null) {
  const fail = (error: unknown): void => {
    const words = error instanceof Error ? error.message : String(error);
    root.append(el("p", { class: "failed", role: "alert" }, `This page cannot be shown: ${words}.`));
    throw error;
  };
  if (text === "") root.append(el("p", {}, "This page holds no data; ajar fills it."));
  else show(root, JSON.parse(text) as PageData).then(() => (root.dataset.ready = "yes"), fail);
}
