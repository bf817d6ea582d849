#include "page.hpp"

namespace ajar::page {

const std::string_view kStyle = R"css(
:root{--bg:#f6f7f9;--card:#fff;--ink:#1b1f24;--soft:#5b6570;--line:#d9dee4;--band:#e9edf2;--good:#0b7a4b;--bad:#b3261e;
--c1:#1f5fbf;--c2:#d0611a;--c3:#12805c;--c4:#8e44ad;--c5:#b58900;--c6:#c2185b;--c7:#00838f;--c8:#5d4037;--truth:#1b1f24;--leaf:#c9b28a;--wall:#c3cad2}
@media (prefers-color-scheme:dark){:root{--bg:#14171b;--card:#1d2126;--ink:#e6e9ed;--soft:#9aa5b1;--line:#343b44;--band:#262c33;
--good:#4cc38a;--bad:#ff8a80;--c1:#78a9ff;--c2:#ff9a57;--c3:#5fd3a6;--c4:#c99bea;--c5:#e3c14d;--c6:#f48fb1;--c7:#4dd0e1;--c8:#bcaaa4;
--truth:#f1f3f5;--leaf:#8a744c;--wall:#454d57}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--ink);font:15px/1.45 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
header,main,footer{max-width:1500px;margin:0 auto;padding:16px 20px}
h1{font-size:26px;margin:0 0 4px;font-weight:650}
h2{font-size:15px;margin:0 0 6px;font-weight:650}
p{margin:4px 0}
.soft{color:var(--soft)}
.badge{display:inline-block;padding:2px 10px;border-radius:12px;font-size:15px;font-weight:650;vertical-align:3px;margin-right:8px;color:var(--card)}
.badge.good{background:var(--good)}.badge.bad{background:var(--bad)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:10px;margin-top:12px}
.tile{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:8px 12px}
.tile b{display:block;font-size:21px;font-weight:650;font-variant-numeric:tabular-nums}
.tile span{color:var(--soft);font-size:13px}
main{display:grid;grid-template-columns:minmax(340px,5fr) minmax(420px,7fr);gap:16px;align-items:start}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:12px}
#left{position:sticky;top:10px}
#plots{display:grid;gap:10px}
canvas{width:100%;display:block;touch-action:pan-y}
#top{height:min(62vh,640px)}
.plot canvas{height:150px;cursor:crosshair}
.legend{display:flex;flex-wrap:wrap;gap:2px 14px;font-size:13px;color:var(--soft);font-variant-numeric:tabular-nums}
.legend i{display:inline-block;width:16px;height:0;border-top:3px solid;vertical-align:4px;margin-right:5px}
.legend i.dash{border-top-style:dashed}.legend i.box{height:10px;border:0;vertical-align:-1px;opacity:.45}
.legend b{color:var(--ink);font-weight:600}
.bar{display:flex;gap:8px;align-items:center;flex-wrap:wrap;margin:8px 0 0}
button{font:inherit;font-size:13px;padding:3px 10px;border:1px solid var(--line);border-radius:6px;background:var(--band);color:var(--ink);cursor:pointer}
input[type=range]{flex:1;min-width:120px}
table{border-collapse:collapse;font-size:14px}td,th{padding:2px 12px 2px 0;text-align:left;vertical-align:top}
pre{overflow:auto;max-height:420px;font-size:13px;background:var(--band);padding:10px;border-radius:6px}
details{margin-top:10px}summary{cursor:pointer;color:var(--soft)}
@media (max-width:900px){main{grid-template-columns:1fr}#left{position:static}}
@media print{#left{position:static}main{display:block}}
)css";

const std::string_view kBody = R"html(
<header><h1><span id="badge" class="badge"></span><span id="headline"></span></h1><p id="belief"></p><p id="why" class="soft"></p><div id="tiles" class="tiles"></div></header>
<main>
<section id="left"><div class="card"><h2>From above</h2><canvas id="top"></canvas><div id="toplegend" class="legend"></div>
<div class="bar"><button id="play" type="button">play</button><input id="scrub" type="range" min="0" max="1" step="any" value="0" aria-label="time"><b id="now"></b></div></div></section>
<section><div class="bar" style="margin:0 0 8px"><button id="whole" type="button">whole run</button><button id="opening" type="button">opening only</button>
<span class="soft">move over a plot to read values at one time in all; drag to zoom, double-click to zoom out</span></div><div id="plots"></div></section>
</main>
<footer><div class="card"><div id="notes"></div><details><summary>all figures of the result</summary><div id="figures"></div></details>
<details><summary>the scenario</summary><pre id="scenario"></pre></details></div></footer>
<noscript><p>The plots need JavaScript. The figures stand in result.json and log.csv beside this page.</p></noscript>
)html";

}  // namespace ajar::page
